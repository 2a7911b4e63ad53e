#include "supple/io/scene_parts.h"

namespace supple::io {

namespace {

std::size_t read_body_number(const JsonNode& node, const Scene& scene) {
    if (!node.has("body")) return 0;
    const JsonNode value = node.at("body");
    if (value.is_number()) return std::size_t(value.integer(0, std::int64_t(scene.bodies.size()) - 1));
    const std::string name = value.text();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        if (scene.bodies[i].def.name == name) return i;
    value.fail(value.shown() + " is no name of a body of this scene; give a name or a number from 0 to " + std::to_string(scene.bodies.size() - 1));
}

/// [begin, end], or one moment.
void read_times(const JsonNode& node, double& begin_s, double& end_s) {
    const JsonNode times = node.at("times_s", "give [begin, end]");
    if (times.is_number()) {
        begin_s = end_s = times.number(0, 1e9);
        return;
    }
    if (!times.is_array() || times.size() != 2) times.fail("must be [begin, end], or one number");
    begin_s = times.item(0).number(0, 1e9);
    end_s = times.item(1).number(0, 1e9);
    if (end_s < begin_s) times.fail("ends before it begins");
}

std::vector<Vec3> read_points(const JsonNode& node) {
    std::vector<Vec3> points;
    for (const JsonNode& point : node.items()) points.push_back(point.vec3(1e9));
    if (points.size() < 2) node.fail("a blade is a list of two points or more");
    return points;
}

constexpr std::int64_t kMostIndex = 2147483647;

template <std::size_t n>
std::array<std::int32_t, n> read_corners(const JsonNode& node) {
    if (!node.is_array() || node.size() != n) node.fail("must be the " + std::to_string(n) + " vertices of an element");
    std::array<std::int32_t, n> corners;
    for (std::size_t k = 0; k < n; ++k) corners[k] = std::int32_t(node.item(k).integer(0, kMostIndex));
    return corners;
}

}  // namespace

void read_events(const JsonNode& node, Scene& scene) {
    for (const JsonNode& entry : node.items()) {
        entry.require_object({"cut", "erase", "heal", "add"});
        if (entry.has("cut") + entry.has("erase") + entry.has("heal") + entry.has("add") != 1) entry.fail("an event is either a \"cut\", an \"erase\", a \"heal\" or an \"add\"");
        if (entry.has("cut")) {
            const JsonNode cut = entry.at("cut");
            cut.require_object({"body", "from_m", "to_m", "times_s", "stride_m", "snap"});
            SceneEdits::Cut out;
            out.body = read_body_number(cut, scene);
            out.event.from_m = read_points(cut.at("from_m"));
            out.event.to_m = read_points(cut.at("to_m"));
            if (out.event.to_m.size() != out.event.from_m.size()) cut.at("to_m").fail("must have as many points as from_m");
            read_times(cut, out.event.begin_s, out.event.end_s);
            if (cut.has("stride_m")) out.event.stride_m = cut.at("stride_m").number_above(0, 1e9);
            if (cut.has("snap")) out.event.def.snap = cut.at("snap").number(0, 0.5);
            scene.events.cuts.push_back(std::move(out));
        } else if (entry.has("heal")) {
            const JsonNode heal = entry.at("heal");
            heal.require_object({"body", "gap_m", "centre_m", "radius_m", "time_s"});
            SceneEdits::Heal out;
            out.body = read_body_number(heal, scene);
            out.event.time_s = heal.at("time_s").number(0, 1e9);
            if (heal.has("gap_m")) out.event.def.gap_m = heal.at("gap_m").number_above(0, 1e9);
            if (heal.has("centre_m") != heal.has("radius_m")) heal.fail("a ball needs both centre_m and radius_m");
            if (heal.has("centre_m")) out.event.def.centre_m = heal.at("centre_m").vec3(1e9);
            if (heal.has("radius_m")) out.event.def.radius_m = heal.at("radius_m").number_above(0, 1e9);
            scene.events.heals.push_back(out);
        } else if (entry.has("add")) {
            const JsonNode add = entry.at("add");
            add.require_object({"body", "vertices_m", "tets", "hexes", "source", "time_s"});
            SceneEdits::Add out;
            out.body = read_body_number(add, scene);
            out.event.time_s = add.at("time_s").number(0, 1e9);
            if (add.has("vertices_m"))
                for (const JsonNode& point : add.at("vertices_m").items()) out.event.elements.vertices.push_back(point.vec3(1e9));
            if (add.has("tets"))
                for (const JsonNode& tet : add.at("tets").items()) out.event.elements.tets.push_back(read_corners<4>(tet));
            if (add.has("hexes"))
                for (const JsonNode& hex : add.at("hexes").items()) out.event.elements.hexes.push_back(read_corners<8>(hex));
            if (out.event.elements.tets.empty() && out.event.elements.hexes.empty()) add.fail("needs tets or hexes");
            const JsonNode source = add.at("source", "the element whose matter the new ones are of: one for all, or a list");
            if (source.is_number()) out.event.elements.source.push_back(std::int32_t(source.integer(0, kMostIndex)));
            else
                for (const JsonNode& element : source.items()) out.event.elements.source.push_back(std::int32_t(element.integer(0, kMostIndex)));
            scene.events.additions.push_back(std::move(out));
        } else {
            const JsonNode erase = entry.at("erase");
            erase.require_object({"body", "from_m", "to_m", "radius_m", "times_s"});
            SceneEdits::Erase out;
            out.body = read_body_number(erase, scene);
            out.event.from_m = erase.at("from_m").vec3(1e9);
            out.event.to_m = erase.has("to_m") ? erase.at("to_m").vec3(1e9) : out.event.from_m;
            out.event.radius_m = erase.at("radius_m").number_above(0, 1e9);
            read_times(erase, out.event.begin_s, out.event.end_s);
            scene.events.erasures.push_back(out);
        }
    }
}

EditScript make_edits(const Scene& scene, const World& world) {
    const std::vector<BodyId> bodies = world.bodies();
    std::vector<CutEvent> cuts;
    for (const SceneEdits::Cut& cut : scene.events.cuts) {
        cuts.push_back(cut.event);
        cuts.back().body = bodies.at(cut.body);
    }
    std::vector<EraseEvent> erasures;
    for (const SceneEdits::Erase& erase : scene.events.erasures) {
        erasures.push_back(erase.event);
        erasures.back().body = bodies.at(erase.body);
    }
    std::vector<HealEvent> heals;
    for (const SceneEdits::Heal& heal : scene.events.heals) {
        heals.push_back(heal.event);
        heals.back().body = bodies.at(heal.body);
    }
    std::vector<AddEvent> additions;
    for (const SceneEdits::Add& add : scene.events.additions) {
        additions.push_back(add.event);
        additions.back().body = bodies.at(add.body);
    }
    return EditScript(std::move(cuts), std::move(erasures), std::move(heals), std::move(additions));
}

}  // namespace supple::io
