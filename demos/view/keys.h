#pragma once
#include "view/desk.h"
#include "view/window.h"

namespace supple::demos::view {

/// What a key does. The table of it is in help.cpp and in the README.
void handle_key(Desk& desk, const KeyPress& key);

/// The GLFW code of "space", "f1", "tab", "escape", "period", a letter or a digit; 0 for any other word.
int key_code(const std::string& name);

}  // namespace supple::demos::view
