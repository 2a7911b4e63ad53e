#include "supple/io/scene_parts.h"

namespace supple::io {

namespace {

std::size_t body_named(const JsonNode& node, const Scene& scene) {
    const std::string name = node.text();
    std::size_t found = scene.bodies.size();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        if (scene.bodies[i].def.name != name) continue;
        if (found < i) node.fail("\"" + name + "\" is the name of two bodies; give each its own");
        found = i;
    }
    if (found == scene.bodies.size()) node.fail("no body of this scene is named \"" + name + "\"; give it this \"name\"");
    return found;
}

std::pair<std::size_t, std::size_t> two_bodies(const JsonNode& node, const Scene& scene) {
    const JsonNode names = node.at("bodies", "give the names of two bodies");
    if (!names.is_array() || names.size() != 2) names.fail("must be the names of two bodies, found " + names.shown());
    return {body_named(names.item(0), scene), body_named(names.item(1), scene)};
}

}  // namespace

void read_pairs(const JsonNode& root, Scene& scene) {
    if (root.has("contacts")) {
        for (const JsonNode& node : root.at("contacts").items()) {
            node.require_object({"bodies", "on"});
            const auto [a, b] = two_bodies(node, scene);
            scene.contacts.push_back({a, b, node.at("on", "true or false").boolean()});
        }
    }
    if (!root.has("ties")) return;
    for (const JsonNode& node : root.at("ties").items()) {
        node.require_object({"bodies", "gap_m", "stiffness_n_m", "max_force_n"});
        SceneTie tie;
        std::tie(tie.body, tie.other) = two_bodies(node, scene);
        if (tie.body == tie.other) node.at("bodies").fail("one body twice; surfaces of two bodies are tied");
        tie.gap_m = node.at("gap_m", "how far apart the surfaces may be, about half an edge of the meshes").number_above(0, 1e6);
        if (node.has("stiffness_n_m")) tie.def.stiffness_n_m = node.at("stiffness_n_m").number(0, 1e12);
        if (node.has("max_force_n")) tie.def.max_force_n = node.at("max_force_n").number(0, 1e12);
        scene.ties.push_back(tie);
    }
}

}  // namespace supple::io
