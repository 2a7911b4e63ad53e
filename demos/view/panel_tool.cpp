#include "view/gui.h"
#include "view/panels.h"

namespace supple::demos::view {

void tool_panel(Desk& desk, double ui_scale) {
    if (!header("Tool", true)) return;
    std::vector<std::string> names;
    for (const auto& tool : desk.tools) names.emplace_back(tool->name());
    int chosen = int(desk.tool);
    if (choice("At hand", "tool", chosen, names, "keys 1 to 5")) desk.choose_tool(std::size_t(chosen));
    quiet_sentence(desk.tool_at_hand().hint());
    desk.tool_at_hand().panel(ui_scale);
    if (!desk.tool_at_hand().edits()) return;
    if (button("Undo", "undo", "the body as it stood before its last cut or bite, eight at most [U]")) desk.wishes.undo = true;
}

}  // namespace supple::demos::view
