#include "view/desk.h"

#include <cstdio>

namespace supple::demos::view {

void Desk::say(const std::string& text, bool is_error, double for_s) {
    message = {text, is_error, for_s};
    std::fprintf(is_error ? stderr : stdout, "supple view: %s\n", text.c_str());
}

void Desk::choose_tool(std::size_t number) {
    if (number >= tools.size() || number == tool) return;
    tool_at_hand().cancel(session.world());
    tool = number;
}

}  // namespace supple::demos::view
