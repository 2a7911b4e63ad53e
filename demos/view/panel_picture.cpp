#include <array>
#include <cstdio>
#include <string_view>

#include "supple/render/color_map.h"
#include "view/gui.h"
#include "view/panels.h"

namespace supple::demos::view {
namespace {

constexpr std::array<std::string_view, 4> kColours = {"as the scene", "plain material", "von Mises stress", "Young's modulus"};
constexpr std::array<std::string_view, 3> kPlaces = {"vertices", "elements", "points inside"};
constexpr std::array<std::string_view, 3> kRanges = {"as the scene", "automatic", "fixed"};

void colours(FrameOptions& frame) {
    int by = frame.color_by ? 1 + int(*frame.color_by) : 0;
    if (choice("Colours", "colours", by, kColours, "Young's modulus shows how heterogeneous the bodies are [M]")) {
        frame.color_by.reset();
        if (by > 0) frame.color_by = ColorBy(by - 1);
    }
    int at = int(frame.stress_at);
    if (choice("Stress at", "stress at", at, kPlaces, "smooth over vertices, flat per element, or a point in the middle of each [E]")) frame.stress_at = FrameOptions::At(at);
}

void range(Desk& desk) {
    choice("Range", "range", desk.range_kind, kRanges, "of the colours; automatic: 99 % of the stresses, changed calmly");
    if (RangeKind(desk.range_kind) == RangeKind::fixed)
        slider("Up to", "range high", desk.range_high_pa, 1, 1e9, "%.3g Pa", "stress that has the last colour; Ctrl click to type a number", true);
}

}  // namespace

void picture_panel(Desk& desk) {
    if (!header("Picture", true)) return;
    colours(desk.frame);
    range(desk);
    int map = 0;
    const auto maps = color_map_names();
    for (std::size_t i = 0; i < maps.size(); ++i) map = maps[i] == desk.frame.map ? int(i) : map;
    if (choice("Colour map", "map", map, maps, "viridis and cividis are read well by everybody")) desk.frame.map = std::string(maps[std::size_t(map)]);
    double opacity = desk.frame.opacity.value_or(desk.frame.stress_at == FrameOptions::At::point ? 0.25 : 1.0);
    if (slider("Opacity", "opacity", opacity, 0.05, 1, "%.2f", "of the bodies")) desk.frame.opacity = opacity;
    checkbox("Wireframe", "wireframe", desk.frame.wireframe, "edges of the elements [W]");
    ImGui::SameLine();
    checkbox("Ground", "ground", desk.ground, "the floor that catches the shadow [G]");
    checkbox("Numbers", "hud", desk.hud, "the line at the top of the picture");
    ImGui::SameLine();
    checkbox("Captions", "captions", desk.captions, "what the demo says");
    checkbox("Contacts", "contacts", desk.frame.contacts, "forces of the contacts with rigid shapes, as arrows");
}

}  // namespace supple::demos::view
