#include "models/belief/gaussian.hpp"
