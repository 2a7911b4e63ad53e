#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>

#include "view/gui.h"
#include "view/panels.h"

namespace supple::demos::view {
namespace {

constexpr ImU32 kFrame = IM_COL32(30, 33, 38, 255), kQuiet = IM_COL32(150, 156, 165, 255);
constexpr std::array<ImU32, 4> kLines = {IM_COL32(240, 240, 240, 255), IM_COL32(86, 180, 233, 255), IM_COL32(230, 159, 0, 255), IM_COL32(0, 190, 130, 255)};

struct Line {
    const char* name;
    const History* values;
};

/// 1, 2 or 5 times a power of ten, at least the value.
float round_top(float value) {
    if (!(value > 0)) return 1;
    const float decade = std::pow(10.0f, std::floor(std::log10(value)));
    for (const float step : {1.0f, 2.0f, 5.0f})
        if (value <= step * decade) return step * decade;
    return 10 * decade;
}

std::string label_of(const Line& line, bool with_number) {
    char text[48];
    std::snprintf(text, sizeof text, "%s %.3g", line.name, double(line.values->last()));
    return with_number ? text : line.name;
}

/// Whether the names with their last values stand side by side.
bool fits(std::span<const Line> lines, float width) {
    float used = 0;
    for (const Line& line : lines) used += ImGui::CalcTextSize(label_of(line, true).c_str()).x + 0.8f * ImGui::GetFontSize();
    return used - 0.8f * ImGui::GetFontSize() <= width;
}

/// A box with curves, its title and the last value of each in the colour of its curve.
void plot(const char* title, const char* unit, std::span<const Line> lines, float width, float height) {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::Dummy(ImVec2(width, height));
    controls().mark(std::string("plot/") + title);
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const float font = ImGui::GetFontSize(), pad = 0.35f * font;
    draw.AddRectFilled(corner, ImVec2(corner.x + width, corner.y + height), kFrame, 4);
    float most = 0;
    for (const Line& line : lines) most = std::max(most, line.values->largest());
    const float top = round_top(most);
    char text[64];
    std::snprintf(text, sizeof text, "%s, to %g %s", title, double(top), unit);
    draw.PushClipRect(corner, ImVec2(corner.x + width, corner.y + height), true);
    draw.AddText(ImVec2(corner.x + pad, corner.y + 0.5f * pad), kQuiet, text);
    const float y0 = corner.y + 2.6f * font, y1 = corner.y + height - pad, x0 = corner.x + pad, x1 = corner.x + width - pad;
    const bool numbers = fits(lines, width - 2 * pad);
    float label_x = corner.x + pad;
    for (std::size_t l = 0; l < lines.size(); ++l) {
        const History& values = *lines[l].values;
        std::array<ImVec2, History::kLength> points;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const float along = float(i + History::kLength - values.size()) / float(History::kLength - 1);
            points[i] = ImVec2(x0 + along * (x1 - x0), y1 - std::clamp(values[i] / top, 0.0f, 1.0f) * (y1 - y0));
        }
        if (values.size() > 1) draw.AddPolyline(points.data(), int(values.size()), kLines[l % kLines.size()], 0, std::max(1.0f, font / 11));
        const std::string label = label_of(lines[l], numbers);
        draw.AddText(ImVec2(label_x, corner.y + 0.5f * pad + 1.15f * font), kLines[l % kLines.size()], label.c_str());
        label_x += ImGui::CalcTextSize(label.c_str()).x + 0.8f * font;
    }
    draw.PopClipRect();
}

/// The stages of the steps of a frame, stacked; what is left of the frame is drawing and waiting.
void stage_plot(const Curves& curves, float width, float height) {
    constexpr std::array<Stage, 3> kShown = {Stage::elements, Stage::assemble, Stage::solve};
    constexpr std::array<const char*, 3> kNames = {"elements", "matrix", "solve"};
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::Dummy(ImVec2(width, height));
    controls().mark("plot/stages");
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const float font = ImGui::GetFontSize(), pad = 0.35f * font;
    draw.AddRectFilled(corner, ImVec2(corner.x + width, corner.y + height), kFrame, 4);
    const float top = round_top(curves.steps_ms.largest());
    char text[64];
    std::snprintf(text, sizeof text, "Steps, to %g ms", double(top));
    draw.PushClipRect(corner, ImVec2(corner.x + width, corner.y + height), true);
    draw.AddText(ImVec2(corner.x + pad, corner.y + 0.5f * pad), kQuiet, text);
    const float y0 = corner.y + 2.6f * font, y1 = corner.y + height - pad, x0 = corner.x + pad, x1 = corner.x + width - pad;
    const std::size_t n = curves.steps_ms.size();
    const float bar = (x1 - x0) / float(History::kLength);
    for (std::size_t i = 0; i < n; ++i) {
        const float x = x0 + bar * float(i + History::kLength - n);
        float below = 0;
        const auto pile = [&](float ms, ImU32 color) {
            const float low = y1 - std::min(1.0f, below / top) * (y1 - y0), high = y1 - std::min(1.0f, (below + ms) / top) * (y1 - y0);
            if (low > high) draw.AddRectFilled(ImVec2(x, high), ImVec2(x + bar, low), color);
            below += ms;
        };
        for (std::size_t s = 0; s < kShown.size(); ++s) pile(curves.stage_ms[std::size_t(kShown[s])][i], kLines[s + 1]);
        pile(std::max(0.0f, curves.steps_ms[i] - below), kQuiet);
    }
    float label_x = corner.x + pad;
    const auto label = [&](const char* name, ImU32 color) {
        draw.AddText(ImVec2(label_x, corner.y + 0.5f * pad + 1.15f * font), color, name);
        label_x += ImGui::CalcTextSize(name).x + 0.6f * font;
    };
    for (std::size_t s = 0; s < kShown.size(); ++s) label(kNames[s], kLines[s + 1]);
    label("rest", kQuiet);
    draw.PopClipRect();
}

}  // namespace

void plots(Desk& desk, float width, float height) {
    const Curves& c = desk.curves;
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const bool row = height > 0;
    const float w = row ? (width - 4 * gap) / 5 : width, h = row ? height : 6.5f * ImGui::GetFontSize();
    const auto next = [&] {
        if (row) ImGui::SameLine(0, gap);
    };
    stage_plot(c, w, h);
    next();
    const std::array<Line, 3> times = {Line{"all", &c.frame_ms}, Line{"steps", &c.steps_ms}, Line{"draw", &c.draw_ms}};
    plot("Frame", "ms", times, w, h);
    next();
    const std::array<Line, 1> iterations = {Line{"a step", &c.iterations}};
    plot("Iterations", "", iterations, w, h);
    next();
    const std::array<Line, 2> energy = {Line{"kinetic", &c.kinetic_j}, Line{"elastic", &c.elastic_j}};
    plot("Energy", "J", energy, w, h);
    next();
    const std::array<Line, 1> force = {Line{"tool", &c.force_n}};
    plot("Force", "N", force, w, h);
}

}  // namespace supple::demos::view
