#include "models/motion/unicycle.hpp"
