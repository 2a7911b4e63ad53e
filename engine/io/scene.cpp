#include "supple/io/scene.h"

#include "supple/io/binary_file.h"
#include "supple/io/scene_parts.h"
#include "supple/io/text_scanner.h"

namespace supple::io {

void require_keys(const JsonNode& node, std::vector<std::string_view> known, std::initializer_list<std::string_view> planned,
                  const std::string& message) {
    known.insert(known.end(), planned);
    node.require_object(known);
    for (std::string_view key : planned) {
        if (node.has(key)) node.at(key).unsupported(quoted(key) + " " + message);
    }
}

Scene parse_scene(const std::string& text, const std::filesystem::path& folder, const std::string& name, int refine) {
    const nlohmann::json document = parse_json(text, name);
    const JsonNode root(document, name);
    root.require_object({"supple_scene", "time_step_s", "gravity_m_s2", "threads", "solver", "bodies", "colliders", "contacts", "ties", "camera", "events"});
    const JsonNode version = root.at("supple_scene", "a scene file begins with \"supple_scene\": 1");
    if (version.number() != 1)
        version.unsupported("version " + version.shown() + " of the scene format is not read; this build reads version 1");

    Scene scene;
    if (root.has("time_step_s")) scene.world.time_step_s = root.at("time_step_s").number_above(0, 1);
    if (root.has("gravity_m_s2")) scene.world.gravity_m_s2 = root.at("gravity_m_s2").vec3(1e6);
    if (root.has("threads")) scene.world.threads = int(root.at("threads").integer(0, 256));
    if (root.has("solver")) scene.world.solver = read_solver(root.at("solver"));
    if (root.has("camera")) scene.camera = read_camera(root.at("camera"));
    SceneContext context{folder, {}};
    context.refine = refine;
    const JsonNode bodies = root.at("bodies", "give a list of at least one body");
    for (const JsonNode& body : bodies.items()) scene.bodies.push_back(read_body(body, context));
    if (scene.bodies.empty()) bodies.fail("the list is empty; give at least one body");
    if (root.has("colliders")) {
        for (const JsonNode& collider : root.at("colliders").items()) scene.colliders.push_back(read_collider(collider, context));
    }
    read_pairs(root, scene);
    if (root.has("events")) read_events(root.at("events"), scene);
    return scene;
}

Scene read_scene(const std::filesystem::path& file, int refine) { return parse_scene(read_text_file(file), file.parent_path(), file.string(), refine); }

World build_world(const Scene& scene, const LogSink& log) {
    WorldDef def = scene.world;
    if (log) def.log = log;
    World world(def);
    std::vector<BodyId> ids;
    for (const SceneBody& body : scene.bodies) {
        const BodyId id = world.add_body(body.def);
        ids.push_back(id);
        for (const SceneBody::Support& support : body.fixed) world.fix(id, support.where, support.axes);
        for (const Motion& motion : body.prescribed) world.prescribe(id, motion);
        for (const Load& load : body.loads) world.add_load(id, load);
    }
    for (const ColliderDef& collider : scene.colliders) world.add_collider(collider);
    for (const ScenePair& pair : scene.contacts) world.set_contact(ids[pair.a], ids[pair.b], pair.on);
    for (const SceneTie& tie : scene.ties) {
        if (world.tie(ids[tie.body], ids[tie.other], tie.gap_m, tie.def).empty()) {
            throw Error(ErrorCode::invalid_argument, "ties", "no vertex of \"" + world.name(ids[tie.body]) + "\" is within " + to_text(tie.gap_m) + " m of \"" +
                                                                 world.name(ids[tie.other]) + "\"; enlarge gap_m or move them together");
        }
    }
    return world;
}

}  // namespace supple::io
