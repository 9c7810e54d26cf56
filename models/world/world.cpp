#include "models/world/world.hpp"
