#include "models/exchange/messages.hpp"
