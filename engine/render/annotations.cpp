#include "supple/render/annotations.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "supple/render/color_map.h"
#include "supple/render/legend.h"

namespace supple::render {
namespace {

constexpr Rgba kInk{246, 248, 250, 255};
constexpr Rgba kQuietInk{226, 231, 236, 255};
constexpr Rgba kPanel{18, 22, 28, 132};

struct Layout {
    float unit;  // 1 at 720 lines
    int width, height;
    int font(float size) const { return std::max(11, int(std::lround(size * unit))); }
};

void draw_legend(Overlay& o, const ColorScale& scale, const Layout& at) {
    const LegendTicks ticks = legend_ticks(scale.low, scale.high, scale.unit, at.height < 400 ? 4 : 6);
    const int size = at.font(18);
    const float pad = 13 * at.unit, bar_w = 20 * at.unit, bar_h = std::round(0.42f * float(at.height)), gap = 8 * at.unit;
    const float line = float(size) * 1.15f;
    const std::string unit = ticks.unit.empty() ? "" : "[" + ticks.unit + "]";

    float widest = o.text_width(size, "0000");  // so that the panel does not breathe while the range moves
    for (const LegendTick& tick : ticks.ticks) widest = std::max(widest, o.text_width(size, tick.text));
    const float inner = std::max({bar_w + gap + widest, o.text_width(size, scale.title), o.text_width(size, unit)});
    const float heading = (scale.title.empty() ? 0 : line) + (unit.empty() ? 0 : line) + 6 * at.unit;
    const float panel_w = std::round(inner + 2 * pad), panel_h = std::round(heading + bar_h + 2 * pad + 0.5f * line);
    const float left = float(at.width) - panel_w - std::round(22 * at.unit), top = std::round(0.5f * (float(at.height) - panel_h));
    o.box(left, top, panel_w, panel_h, 9 * at.unit, kPanel);

    float y = top + pad + o.ascent(size) - 0.1f * float(size);
    if (!scale.title.empty()) {
        o.text(left + pad, y, size, kInk, scale.title);
        y += line;
    }
    if (!unit.empty()) o.text(left + pad, y, size, kQuietInk, unit);

    const float bar_x = std::round(left + pad), bar_y = std::round(top + pad + heading);
    const ColorTable& table = color_map(scale.map);
    constexpr std::size_t kSteps = 85;  // 255 = 3 x 85: each strip runs between two entries of the table
    for (std::size_t i = 0; i < kSteps; ++i) {
        const auto color = [&](std::size_t k) { return Rgba{table[k][0], table[k][1], table[k][2], 255}; };
        const float upper = std::round(bar_h * float(i) / kSteps), lower = std::round(bar_h * float(i + 1) / kSteps);
        o.gradient(bar_x, bar_y + upper, bar_w, lower - upper, color(255 - 3 * i), color(255 - 3 * (i + 1)));
    }
    for (const LegendTick& tick : ticks.ticks) {
        const double share = std::clamp((tick.value - scale.low) / (scale.high - scale.low), 0.0, 1.0);
        const float tick_y = bar_y + std::round(float(1 - share) * (bar_h - 1));
        o.box(bar_x + bar_w, tick_y, 4 * at.unit, std::max(1.0f, std::round(at.unit)), 0, kInk);
        o.text(bar_x + bar_w + gap, tick_y + 0.34f * float(size), size, kInk, tick.text);
    }
}

void draw_hud(Overlay& o, const std::string& text, const Layout& at) {
    const int size = at.font(17);
    const float pad = 8 * at.unit, x = std::round(20 * at.unit), y = std::round(18 * at.unit);
    o.box(x, y, std::round(o.text_width(size, text) + 2 * pad), std::round(float(size) + pad), 6 * at.unit, kPanel);
    o.text(x + pad, y + 0.5f * pad + o.ascent(size), size, kQuietInk, text);
}

void draw_caption(Overlay& o, const std::string& text, const Layout& at) {
    const int size = at.font(32);
    const float pad = 14 * at.unit, line = std::round(1.18f * float(size));
    const std::vector<std::string> lines = o.wrap(size, 0.72f * float(at.width), text);
    float widest = 0;
    for (const std::string& l : lines) widest = std::max(widest, o.text_width(size, l));
    const float h = line * float(lines.size()) + 1.1f * pad, x = std::round(20 * at.unit),
                y = std::round(float(at.height) - h - 24 * at.unit);
    o.box(x, y, std::round(widest + 2 * pad), std::round(h), 9 * at.unit, kPanel);
    for (std::size_t i = 0; i < lines.size(); ++i)
        o.text(x + pad, y + 0.55f * pad + o.ascent(size) + line * float(i) + 0.5f * (line - float(size)), size, kInk, lines[i]);
}

void draw_labels(Overlay& o, const FrameView& view, const Layout& at) {
    const int size = at.font(16);
    const float pad = 6 * at.unit;
    const Camera& c = view.camera;
    const Vec3 forward = (c.target_m - c.eye_m).normalized(), right = forward.cross(c.up).normalized(), up = right.cross(forward);
    const double half = std::tan(0.5 * c.fov_deg * M_PI / 180);
    for (const LabelView& label : view.labels) {
        const Vec3 d = label.at_m - c.eye_m;
        const double depth = d.dot(forward);
        if (!(depth > 1e-9)) continue;
        const float x = float(0.5 * at.width + 0.5 * at.height * d.dot(right) / (depth * half));
        const float y = float(0.5 * at.height * (1 - d.dot(up) / (depth * half)));
        const float w = std::round(o.text_width(size, label.text) + 2 * pad), h = std::round(float(size) + pad);
        const float left = std::round(x - 0.5f * w), top = std::round(y - 0.5f * h);
        o.box(left, top, w, h, 5 * at.unit, kPanel);
        o.text(left + pad, top + 0.5f * pad + o.ascent(size), size, kInk, label.text);
    }
}

}  // namespace

void annotate(Overlay& overlay, const FrameView& view, bool with_legend, int width, int height) {
    const Layout layout{float(height) / 720, width, height};
    overlay.begin(width, height);
    draw_labels(overlay, view, layout);
    if (with_legend) draw_legend(overlay, *view.scale, layout);
    if (!view.hud.empty()) draw_hud(overlay, view.hud, layout);
    if (!view.caption.empty()) draw_caption(overlay, view.caption, layout);
}

}  // namespace supple::render
