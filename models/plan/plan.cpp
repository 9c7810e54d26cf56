#include "models/plan/plan.hpp"
