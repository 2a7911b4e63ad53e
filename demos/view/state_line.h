#pragma once
#include <string>

#include "view/desk.h"

namespace supple::demos::view {

/// Where everything stands, as one line of JSON: for scripts that check what they did.
std::string state_line(Desk& desk, std::size_t frame);

}  // namespace supple::demos::view
