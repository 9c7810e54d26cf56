#include "models/target/target_model.hpp"
