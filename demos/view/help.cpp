#include <algorithm>
#include <array>

#include "view/gui.h"
#include "view/panels.h"

namespace supple::demos::view {
namespace {

struct Row {
    const char* what;
    const char* does;
};
// The table of the README says the same.
constexpr std::array<Row, 23> kRows = {{
    {"Left button on a body", "use the tool; the scalpel may begin beside it"},
    {"Left button beside, right button", "turn the camera"},
    {"Middle button, Shift + right", "move the camera"},
    {"Wheel", "zoom; with a tool in use: along the line of sight"},
    {"Space", "play, pause"},
    {". (period)", "one time step"},
    {"R", "restart; materials and solver stay as they are"},
    {"- and +", "slower, faster"},
    {"1, 2, 3, 4, 5", "tool: grab, pinch, poke, scalpel, burr"},
    {"U", "undo the last cut or bite; eight at most"},
    {"Escape", "let go; close this help"},
    {"F", "show all bodies"},
    {"M", "colours: stress, stiffness, plain"},
    {"E", "stress per vertex, per element, as points"},
    {"W", "wireframe"},
    {"G", "ground"},
    {"P, Shift + P", "picture of the scene, of the window"},
    {"V", "start, stop a film"},
    {"N, B", "next demo, demo before"},
    {"Tab", "panels on, off"},
    {"F1, H", "this help"},
    {"Ctrl + click on a slider", "type a number"},
    {"Ctrl + Q", "quit"},
}};

}  // namespace

void help_window(Desk& desk, float ui_scale) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float width = std::min(520 * ui_scale, 0.92f * screen.x);
    ImGui::SetNextWindowPos(ImVec2(0.5f * screen.x, 0.5f * screen.y), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(ImVec2(width, std::min(0.92f * screen.y, 29 * ImGui::GetTextLineHeightWithSpacing())));
    ImGui::SetNextWindowFocus();
    if (ImGui::Begin("Keys and mouse", &desk.help, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings)) {
        if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_RowBg)) {
            ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthFixed, 0.46f * width);
            ImGui::TableSetupColumn("does", ImGuiTableColumnFlags_WidthStretch);
            for (const Row& row : kRows) {
                ImGui::TableNextRow();
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(row.what);
                ImGui::TableNextColumn();
                sentence(row.does);
            }
            ImGui::EndTable();
        }
        quiet_sentence("Scene files and meshes can be dropped on the window.");
        controls().mark("help/foot");
    }
    ImGui::End();
}

}  // namespace supple::demos::view
