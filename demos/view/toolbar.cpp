#include <algorithm>
#include <cstdio>

#include "view/gui.h"
#include "view/panels.h"

namespace supple::demos::view {
namespace {

bool fits(float width) { return ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width < ImGui::GetWindowWidth(); }

/// On the same line where there is room; a small window loses the last ones, which have keys too.
bool next_button(const char* label) {
    if (!fits(ImGui::CalcTextSize(label).x + 2 * ImGui::GetStyle().FramePadding.x)) return false;
    ImGui::SameLine();
    return true;
}

void gap() {
    ImGui::SameLine();
    ImGui::Dummy(ImVec2(0.5f * ImGui::GetFontSize(), 0));
}

}  // namespace

void toolbar(Desk& desk) {
    Session& session = desk.session;
    if (button(session.playing ? "Pause" : "Play ", "play", "Space", !session.playing)) session.playing = !session.playing;
    ImGui::SameLine();
    if (button("Step", "step", "one time step [.]")) desk.wishes.step = true;
    ImGui::SameLine();
    if (button("Restart", "restart", "from the beginning, with the materials and the solver as they are now [R]")) desk.wishes.restart = true;
    gap();
    for (std::size_t i = 0; i < desk.tools.size(); ++i) {
        ImGui::SameLine();
        const char* name = desk.tools[i]->name();
        if (button(name, (std::string("tool/") + name).c_str(), desk.tools[i]->hint(), i == desk.tool)) desk.choose_tool(i);
    }
    gap();
    if (next_button("Show all") && button("Show all", "show all", "the camera shows all bodies [F]")) desk.wishes.frame_camera = true;
    if (next_button("Picture") && button("Picture", "picture", "write the scene's picture as PNG [P]; with the panels: [Shift P]")) desk.wishes.picture = true;
    const char* film = desk.recorder.records() ? "Stop" : "Film";
    if (next_button(film) && button(film, "film", "record the scene to a video [V]", desk.recorder.records())) desk.wishes.film = true;
    if (next_button("Help") && button("Help", "help", "keys and mouse [F1]", desk.help)) desk.help = !desk.help;
    char pace[96];
    std::snprintf(pace, sizeof pace, "%.2f s   x %.2f   %.0f frames/s", session.world().time_s(), session.playing ? desk.speed : 0.0, 1 / std::max(desk.frame_s, 1e-6));
    if (!fits(ImGui::CalcTextSize(pace).x + 2 * ImGui::GetFontSize())) return;
    ImGui::SameLine(ImGui::GetWindowWidth() - ImGui::CalcTextSize(pace).x - ImGui::GetFontSize());
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(pace);
    tooltip("simulated time, simulated over real time, frames drawn a second");
}

}  // namespace supple::demos::view
