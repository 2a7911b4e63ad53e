#include "supple/render/annotations.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

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

/// @param least_top  what stands above ends there
void draw_legend(Overlay& o, const ColorScale& scale, const Layout& at, float least_top) {
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
    const float left = float(at.width) - panel_w - std::round(22 * at.unit), top = std::max(std::round(0.5f * (float(at.height) - panel_h)), least_top);
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

Rgba opaque(const std::array<float, 3>& c) {
    const auto byte = [](float v) { return std::uint8_t(std::lround(255 * std::clamp(v, 0.0f, 1.0f))); };
    return {byte(c[0]), byte(c[1]), byte(c[2]), 255};
}

/// One column of pixels after the other, each as high as the curve in it: no line is thinner where it is steep.
void draw_curve(Overlay& o, const PlotView& plot, const PlotView::Curve& curve, float x, float y, float w, float h, float thickness) {
    const auto height_at = [&](double t) {
        const auto after = std::lower_bound(curve.points.begin(), curve.points.end(), t, [](const auto& p, double value) { return p[0] < value; });
        const auto& b = after == curve.points.end() ? curve.points.back() : *after;
        const auto& a = after == curve.points.begin() ? b : *(after - 1);
        const double s = b[0] > a[0] ? (t - a[0]) / (b[0] - a[0]) : 1;
        return std::clamp((a[1] + s * (b[1] - a[1]) - plot.low) / (plot.high - plot.low), 0.0, 1.0);
    };
    const double per_pixel = (plot.end - plot.begin) / double(w);
    for (float column = 0; column < w; column += 1) {
        const double t = plot.begin + double(column) * per_pixel;
        if (t + per_pixel < curve.points.front()[0] || t > curve.points.back()[0]) continue;
        const double a = height_at(t), b = height_at(t + per_pixel);
        const float top = y + h * float(1 - std::max(a, b)), bottom = y + h * float(1 - std::min(a, b));
        o.box(x + column, top - thickness / 2, 1.6f, bottom - top + thickness, 0, opaque(curve.color));
    }
}

/// Returns where it ends.
float draw_plot(Overlay& o, const PlotView& plot, const Layout& at) {
    const int size = at.font(16);
    const float pad = 12 * at.unit, w = std::round(0.30f * float(at.width)), h = std::round(0.15f * float(at.height)), line = 1.25f * float(size);
    const float panel_w = w + 2 * pad, panel_h = std::round(h + 2 * line + 1.6f * pad);
    const float left = float(at.width) - panel_w - std::round(22 * at.unit), top = std::round(18 * at.unit);
    const float x = std::round(left + pad), y = std::round(top + 0.8f * pad + line);
    o.box(left, top, panel_w, panel_h, 9 * at.unit, kPanel);
    float pen = left + pad;
    const float baseline = top + 0.6f * pad + o.ascent(size);
    o.text(pen, baseline, size, kInk, plot.title);
    pen += o.text_width(size, plot.title) + 1.2f * float(size);
    for (const PlotView::Curve& curve : plot.curves) {
        if (curve.name.empty()) continue;
        o.text(pen, baseline, size, opaque(curve.color), curve.name);
        pen += o.text_width(size, curve.name) + 0.9f * float(size);
    }
    constexpr Rgba kLine{226, 231, 236, 70};
    const float hair = std::max(1.0f, std::round(at.unit));
    const auto number = [](double v) {
        char text[32];
        std::snprintf(text, sizeof text, "%.3g", v);
        return std::string(text);
    };
    for (const double value : {plot.low, 0.5 * (plot.low + plot.high), plot.high}) {
        const float at_y = std::round(y + h * float(1 - (value - plot.low) / (plot.high - plot.low)));
        o.box(x, at_y, w, hair, 0, kLine);
        if (value != plot.low) o.text(x + 3 * at.unit, at_y + o.ascent(size) + 1, size, kQuietInk, number(value));
    }
    const float foot = y + h + o.ascent(size) + 3 * at.unit;
    o.text(x, foot, size, kQuietInk, number(plot.begin) + " s");
    const std::string last = number(plot.end) + " s";
    o.text(x + w - o.text_width(size, last), foot, size, kQuietInk, last);
    for (const PlotView::Curve& curve : plot.curves)
        if (!curve.points.empty()) draw_curve(o, plot, curve, x, y, w, h, std::max(2.0f, 2 * at.unit));
    return top + panel_h;
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
    float below = 0;
    if (view.plot && view.plot->end > view.plot->begin && view.plot->high > view.plot->low) below = draw_plot(overlay, *view.plot, layout) + std::round(10 * layout.unit);
    if (with_legend) draw_legend(overlay, *view.scale, layout, below);
    if (!view.hud.empty()) draw_hud(overlay, view.hud, layout);
    if (!view.caption.empty()) draw_caption(overlay, view.caption, layout);
}

}  // namespace supple::render
