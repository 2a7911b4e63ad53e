#include "plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <map>

namespace supple::demos {
namespace {

constexpr double kWidth = 900, kLeft = 210, kRight = 130, kTop = 72, kBottom = 52;
constexpr const char* kInk = "#1f2933";
constexpr const char* kPale = "#6b7785";
constexpr const char* kGrid = "#e3e7eb";
constexpr std::array<const char*, 6> kColour{"#1b6ca8", "#d1605e", "#3f8f5b", "#8a5fb0", "#b8791a", "#4b5563"};

/// SVG text that grows.
class Drawing {
public:
    explicit Drawing(double height) : height_(height) {}
    [[gnu::format(printf, 2, 3)]] void add(const char* format, ...) {
        char text[1024];
        va_list arguments;
        va_start(arguments, format);
        std::vsnprintf(text, sizeof text, format, arguments);
        va_end(arguments);
        body_ += text;
        body_ += '\n';
    }
    void raw(const std::string& svg) { body_ += svg; }
    void text(double x, double y, const char* anchor, const char* colour, int size, const std::string& what) {
        std::string safe;
        for (const char c : what) safe += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
        body_ += "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\" fill=\"" + colour + "\" font-size=\"" +
                 std::to_string(size) + "\">" + safe + "</text>\n";
    }
    void line(double x0, double y0, double x1, double y1, const char* colour, double width) {
        add("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\" stroke-width=\"%.1f\"/>", x0, y0, x1, y1, colour, width);
    }
    std::string svg() const {
        char head[256];
        std::snprintf(head, sizeof head,
                      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" font-family=\"DejaVu Sans, sans-serif\">\n"
                      "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
                      kWidth, height_);
        return head + body_ + "</svg>\n";
    }

private:
    static std::string number(double value) {
        char text[32];
        std::snprintf(text, sizeof text, "%.1f", value);
        return text;
    }
    double height_;
    std::string body_;
};

/// A logarithmic axis between two values of data, on [from, to] of the drawing.
struct LogAxis {
    double low, high, from, to;
    double at(double value) const { return from + (to - from) * (std::log10(value) - low) / (high - low); }
    /// 1, 2 and 5 times the powers of ten that lie on it.
    std::vector<double> ticks() const {
        std::vector<double> out;
        for (int decade = static_cast<int>(std::floor(low)); decade <= static_cast<int>(std::ceil(high)); ++decade) {
            for (const double digit : {1.0, 2.0, 5.0}) {
                const double value = digit * std::pow(10.0, decade);
                if (std::log10(value) >= low - 1e-9 && std::log10(value) <= high + 1e-9) out.push_back(value);
            }
        }
        return out;
    }
};

LogAxis axis_over(double low, double high, double from, double to) {
    const double margin = 0.05 * std::max(0.3, std::log10(high / low));
    return {std::log10(low) - margin, std::log10(high) + margin, from, to};
}

std::string short_number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, value >= 1e6 ? "%.3gM" : value >= 1e3 ? "%.3gk" : "%.3g", value >= 1e6 ? value * 1e-6 : value >= 1e3 ? value * 1e-3 : value);
    return text;
}

/// Share of the values in each of `bins` equal parts of the axis, the largest 1.
std::vector<double> histogram(const std::vector<double>& values, const LogAxis& axis, std::size_t bins) {
    std::vector<double> count(bins, 0);
    for (const double v : values) {
        const double place = (std::log10(v) - axis.low) / (axis.high - axis.low) * double(bins);
        count[std::size_t(std::clamp(place, 0.0, double(bins - 1)))] += 1;
    }
    const double most = *std::max_element(count.begin(), count.end());
    for (double& c : count) c /= most;
    return count;
}

void draw_row(Drawing& d, const Measurement& m, const LogAxis& x, double base, double height) {
    const std::vector<double>& ms = m.statistics.step_ms();
    constexpr std::size_t kBins = 180;
    const std::vector<double> bars = histogram(ms, x, kBins);
    const double width = (x.to - x.from) / double(kBins);
    std::string path = "<path fill=\"" + std::string(kColour[0]) + "\" fill-opacity=\"0.45\" d=\"M" + std::to_string(x.from) + " " + std::to_string(base);
    for (std::size_t i = 0; i < kBins; ++i) {
        const double left = x.from + double(i) * width, top = base - bars[i] * height;
        path += " L" + std::to_string(left) + " " + std::to_string(top) + " L" + std::to_string(left + width) + " " + std::to_string(top);
    }
    path += " L" + std::to_string(x.to) + " " + std::to_string(base) + " Z\"/>\n";
    d.line(x.from, base, x.to, base, kGrid, 1);
    const double median = io::median(ms), p99 = io::percentile(ms, 0.99), most = io::percentile(ms, 1);
    d.raw(path);
    d.line(x.at(median), base, x.at(median), base - height, kColour[0], 2.5);
    d.line(x.at(p99), base, x.at(p99), base - 0.6 * height, kColour[1], 2);
    d.add("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2\" fill=\"%s\"/>", x.at(most), base - 3, kPale);
    d.text(kLeft - 10, base - 3, "end", kInk, 12, m.name);
    char text[64];
    std::snprintf(text, sizeof text, "%.3g / %.3g ms", median, p99);
    d.text(kWidth - kRight + 10, base - 3, "start", kPale, 12, text);
}

}  // namespace

std::string frame_time_svg(const std::vector<Measurement>& all, const std::string& machine) {
    constexpr double kRow = 30;
    double low = 1e300, high = 0;
    for (const Measurement& m : all) {
        low = std::min(low, io::percentile(m.statistics.step_ms(), 1e-9));
        high = std::max(high, io::percentile(m.statistics.step_ms(), 1));
    }
    const double bottom = kTop + kRow * double(all.size());
    Drawing d(bottom + kBottom);
    const LogAxis x = axis_over(low, high, kLeft, kWidth - kRight);
    d.text(20, 26, "start", kInk, 17, "Time of a step");
    d.text(20, 46, "start", kPale, 12, machine);
    d.text(kWidth - kRight + 10, kTop - 8, "start", kPale, 12, "median / p99");
    for (const double tick : x.ticks()) {
        d.line(x.at(tick), kTop, x.at(tick), bottom, kGrid, 1);
        d.text(x.at(tick), bottom + 18, "middle", kPale, 12, short_number(tick));
    }
    d.text(0.5 * (x.from + x.to), bottom + 40, "middle", kPale, 12, "ms, logarithmic; blue line: median, red line: p99, dot: largest");
    for (std::size_t i = 0; i < all.size(); ++i) draw_row(d, all[i], x, kTop + kRow * double(i + 1), kRow - 6);
    return d.svg();
}

std::string cost_svg(const std::vector<Measurement>& all, const std::string& machine) {
    std::map<std::string, std::vector<std::pair<double, double>>> series;  // elements, ns per element
    for (const Measurement& m : all) {
        if (m.series.empty()) continue;
        const double elements = double(m.world.elements);
        series[m.series].emplace_back(elements, 1e6 * io::median(m.statistics.step_ms()) / elements);
    }
    double x_low = 1e300, x_high = 0, y_low = 1e300, y_high = 0;
    for (auto& [name, points] : series) {
        std::sort(points.begin(), points.end());
        for (const auto& [elements, ns] : points) {
            x_low = std::min(x_low, elements);
            x_high = std::max(x_high, elements);
            y_low = std::min(y_low, ns);
            y_high = std::max(y_high, ns);
        }
    }
    if (!(x_high > x_low)) return {};
    constexpr double kHeight = 520, kPlotLeft = 80;
    Drawing d(kHeight);
    const LogAxis x = axis_over(x_low, x_high, kPlotLeft, kWidth - kRight), y = axis_over(y_low / 1.1, y_high * 1.1, kHeight - kBottom, kTop);
    d.text(20, 26, "start", kInk, 17, "Time of a step per element, ns");
    d.text(20, 46, "start", kPale, 12, machine);
    for (const double tick : x.ticks()) {
        d.line(x.at(tick), y.from, x.at(tick), y.to, kGrid, 1);
        d.text(x.at(tick), y.from + 18, "middle", kPale, 12, short_number(tick));
    }
    for (const double tick : y.ticks()) {
        d.line(x.from, y.at(tick), x.to, y.at(tick), kGrid, 1);
        d.text(x.from - 8, y.at(tick) + 4, "end", kPale, 12, short_number(tick));
    }
    d.text(0.5 * (x.from + x.to), kHeight - 12, "middle", kPale, 12, "elements; both axes logarithmic");
    std::vector<double> label_at;
    std::size_t colour = 0;
    for (const auto& [name, points] : series) {
        const char* stroke = kColour[colour++ % kColour.size()];
        std::string line;
        for (const auto& [elements, ns] : points) line += std::to_string(x.at(elements)) + "," + std::to_string(y.at(ns)) + " ";
        d.add("<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"2\" points=\"%s\"/>", stroke, line.c_str());
        for (const auto& [elements, ns] : points)
            d.add("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"%s\" stroke=\"white\"/>", x.at(elements), y.at(ns), stroke);
        double at = y.at(points.back().second) + 4;  // beside the last point, below labels that are there already
        for (bool moved = true; moved;) {
            moved = false;
            for (const double other : label_at) {
                if (std::abs(other - at) >= 15) continue;
                at = other + 15;
                moved = true;
            }
        }
        label_at.push_back(at);
        d.text(std::min(x.at(points.back().first) + 10, x.to + 8), at, "start", stroke, 12, name);
    }
    return d.svg();
}

}  // namespace supple::demos
