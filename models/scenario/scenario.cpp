#include "models/scenario/scenario.hpp"
