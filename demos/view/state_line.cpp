#include "view/state_line.h"

#include "json_text.h"
#include "statistics.h"
#include "view/material_edit.h"

namespace supple::demos::view {
namespace {

std::string truth(bool value) { return value ? "true" : "false"; }

}  // namespace

std::string state_line(Desk& desk, std::size_t frame) {
    Session& session = desk.session;
    const World& world = session.world();
    JsonObject line;
    line.add("frame", json(frame)).add("scene", json(session.name())).add("time_s", json(world.time_s())).add("steps", json(std::size_t(world.step_count())));
    line.add("hash", json(hash_text(world.hash()))).add("playing", truth(session.playing)).add("script", truth(session.script_plays()));
    line.add("tool", json(std::string_view(desk.tools[desk.tool]->name()))).add("holds", truth(desk.tools[desk.tool]->holds()));
    line.add("force_n", json(desk.tools[desk.tool]->force_n(world)));
    line.add("tolerance", json(world.def().solver.cg_relative_tolerance)).add("legend_high", json(desk.legend_high));
    line.add("eye_m", json(desk.camera.camera().eye_m)).add("panels", truth(desk.panels)).add("help", truth(desk.help));
    line.add("message", json(desk.message.text));
    const std::vector<BodyId> bodies = world.bodies();
    line.add("bodies", json(bodies.size()));
    if (desk.body < bodies.size()) {
        const BodyDef& def = world.definition(bodies[desk.body]);
        Vec3 centre = Vec3::Zero();
        const auto positions = world.positions(bodies[desk.body]);
        for (const Vec3& x : positions) centre += x / double(positions.size());
        const Moduli moduli = moduli_of(def.material);
        line.add("body", json(world.name(bodies[desk.body]))).add("law", json(law_names()[def.material.index()]));
        line.add("young_pa", json(moduli.young_pa)).add("poisson", json(moduli.poisson)).add("factor", json(session.stiffness_factor(desk.body)));
        const BodyId id = bodies[desk.body];
        line.add("elements", json(world.shape(id).mesh().element_count())).add("edits", json(std::size_t(world.edit_count(id)))).add("pieces", json(world.pieces(id).size()));
        line.add("centre_m", json(centre)).add("elastic_j", json(world.energy().elastic_j));
    }
    return line.line();
}

}  // namespace supple::demos::view
