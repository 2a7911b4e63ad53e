#include "view/panels.h"

#include <algorithm>
#include <cmath>

#include "view/gui.h"

namespace supple::demos::view {
namespace {

constexpr ImGuiWindowFlags kPart = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings;

void begin_part(const char* name, float x, float y, float width, float height, ImGuiWindowFlags more = 0) {
    ImGui::SetNextWindowPos(ImVec2(x, y));
    ImGui::SetNextWindowSize(ImVec2(width, height));
    ImGui::Begin(name, nullptr, kPart | more);
}

void side_panel(Desk& desk, bool with_plots, float ui_scale) {
    ImGui::PushItemWidth(-8.2f * ImGui::GetFontSize());  // room for the labels at the right
    scene_panel(desk);
    tool_panel(desk, double(ui_scale));
    material_panel(desk);
    picture_panel(desk);
    solver_panel(desk);
    time_panel(desk);
    report_panel(desk);
    if (with_plots && header("Plots", false)) plots(desk, ImGui::GetContentRegionAvail().x, 0);
    ImGui::PopItemWidth();
}

void note(const char* text, const ImVec4& color, const Viewport& view, float ui_scale) {
    ImGui::SetNextWindowPos(ImVec2(view.x + 0.5f * view.width, view.y + 46 * ui_scale), 0, ImVec2(0.5f, 0));
    ImGui::SetNextWindowBgAlpha(0.92f);
    ImGui::PushStyleColor(ImGuiCol_WindowBg, color);
    ImGui::Begin("note", nullptr, kPart | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs);
    ImGui::PushTextWrapPos(std::min(0.85f * view.width, 42 * ImGui::GetFontSize()));
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::End();
    ImGui::PopStyleColor();
}

/// Over the picture: what was just done or went wrong; otherwise what the steps complain of, with its cure.
void note_line(const Desk& desk, float ui_scale) {
    if (!desk.message.text.empty() && desk.message.left_s > 0) {
        const ImVec4 color = desk.message.is_error ? ImVec4(0.42f, 0.10f, 0.10f, 1) : ImVec4(0.10f, 0.24f, 0.16f, 1);
        return note(desk.message.text.c_str(), color, desk.viewport, ui_scale);
    }
    for (const FlagNote& flag : desk.session.flags()) {
        if (flag.quiet >= FlagNote::kLately) continue;
        const std::string text = std::string(name(flag.flag)) + ": " + std::string(cure(flag.flag)) + ".";
        return note(text.c_str(), ImVec4(0.40f, 0.25f, 0.08f, 1), desk.viewport, ui_scale);
    }
}

}  // namespace

void draw_panels(Desk& desk, float width, float height, float ui_scale) {
    desk.viewport = {0, 0, width, height};
    if (desk.panels) {
        const ImGuiStyle& style = ImGui::GetStyle();
        const float bar = std::round(ImGui::GetFrameHeight() + 2 * style.WindowPadding.y);
        const float side = std::round(std::min(330 * ui_scale, 0.46f * width));
        const bool roomy = width >= 1000 * ui_scale && height >= 640 * ui_scale;
        const float strip = roomy ? std::round(142 * ui_scale) : 0;
        begin_part("toolbar", 0, 0, width, bar, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
        toolbar(desk);
        ImGui::End();
        begin_part("panel", 0, bar, side, height - bar);
        side_panel(desk, !roomy, ui_scale);
        ImGui::End();
        if (roomy) {
            begin_part("plots", side, height - strip, width - side, strip, ImGuiWindowFlags_NoScrollbar);
            plots(desk, ImGui::GetContentRegionAvail().x, ImGui::GetContentRegionAvail().y);
            ImGui::End();
        }
        desk.viewport = {side, bar, std::max(width - side, 32.0f), std::max(height - bar - strip, 32.0f)};
    }
    note_line(desk, ui_scale);
    if (desk.help) help_window(desk, ui_scale);
}

}  // namespace supple::demos::view
