#include <algorithm>
#include <cstdio>

#include "view/gui.h"
#include "view/panels.h"

namespace supple::demos::view {
namespace {

void demo_list(Desk& desk) {
    const std::string now = desk.session.name();
    const bool open = ImGui::BeginCombo("Scene", now.c_str(), ImGuiComboFlags_HeightLarge);
    if (open) {
        for (const Demo& demo : all_demos()) {
            if (ImGui::Selectable(demo.name.c_str(), demo.name == now)) desk.wishes.open = demo.name;
            controls().mark("scene/" + demo.name);
            tooltip(demo.summary.c_str());
        }
        ImGui::EndCombo();
    }
    controls().mark("scene");
    if (!open) tooltip("the demos; a scene or mesh file can be dropped on the window");
}

void body_list(Desk& desk) {
    const World& world = desk.session.world();
    const std::vector<BodyId> bodies = world.bodies();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const VolumeMesh& mesh = world.shape(bodies[b]).mesh();
        char line[160];
        std::snprintf(line, sizeof line, "%s%s   %zu elements##%zu", world.name(bodies[b]).c_str(), world.is_frozen(bodies[b]) ? " (frozen)" : "",
                      mesh.tets.size() + mesh.hexes.size(), b);
        if (ImGui::Selectable(line, b == desk.body)) desk.body = b;
        controls().mark("body/" + world.name(bodies[b]));
        char more[160];
        double mass_kg = 0;
        for (const double m : world.masses(bodies[b])) mass_kg += m;
        std::snprintf(more, sizeof more, "%zu vertices, %zu tets, %zu hexes, %.4g kg", mesh.vertices.size(), mesh.tets.size(), mesh.hexes.size(), mass_kg);
        tooltip(more);
    }
    if (bodies.empty()) quiet_sentence("No bodies: open a demo, or drop a scene or mesh file on the window.");
}

}  // namespace

void scene_panel(Desk& desk) {
    if (!header("Bodies", true)) return;
    demo_list(desk);
    const std::size_t shown = std::min<std::size_t>(desk.session.world().bodies().size(), 6);
    if (desk.session.world().bodies().size() <= 6) return body_list(desk);
    ImGui::BeginChild("list", ImVec2(0, float(shown) * ImGui::GetTextLineHeightWithSpacing()), true);
    body_list(desk);
    ImGui::EndChild();
}

}  // namespace supple::demos::view
