#include "models/world/grid.hpp"
