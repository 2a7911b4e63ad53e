#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "supple/io/json_node.h"
#include "supple/io/scene.h"

namespace supple::io {

/// What the readers of a scene's parts share.
struct SceneContext {
    std::filesystem::path folder;                                                          ///< mesh paths are relative to it
    std::map<std::tuple<std::string, std::string, double>, std::shared_ptr<const BodyTemplate>> shapes;  ///< by file, up and scale: bodies share them
    std::map<std::pair<std::string, const BodyTemplate*>, std::shared_ptr<const Skin>> skins{};  ///< by surface file and shape
    int refine = 0;  ///< times that every mesh is refined besides what its body says
};

/// `node` must be an object with keys out of `known` and `planned`; one of `planned` is Error(unsupported) with `message`.
void require_keys(const JsonNode& node, std::vector<std::string_view> known, std::initializer_list<std::string_view> planned = {},
                  const std::string& message = {});

SolverDef read_solver(const JsonNode& node);
SceneCamera read_camera(const JsonNode& node);
SceneBody read_body(const JsonNode& node, SceneContext& context);
ColliderDef read_collider(const JsonNode& node, SceneContext& context);
/// contacts and ties: what is said of two bodies.
void read_pairs(const JsonNode& root, Scene& scene);

/// Reads the scene's events; its bodies are known.
void read_events(const JsonNode& node, Scene& scene);

/// A box given by corners: min_m below max_m in every coordinate (or equal, where `may_be_flat`).
InsideBox read_box(const JsonNode& node, bool may_be_flat);
/// "all", {"box"}, {"sphere"}, {"capsule"}, {"vertices"}, {"group"} or {"all": true}, also under the key "selection"; at least one vertex is selected.
Selection read_selection(const JsonNode& node, const VolumeMesh& mesh);
/// Fills fixed, prescribed and loads.
void read_supports_and_loads(const JsonNode& node, SceneBody& body);

/// Fills probes.
void read_probes(const JsonNode& node, SceneBody& body);

/// The selection keys that an entry of `fixed`, `prescribed`, `loads`, `probes` or `regions` may hold directly.
inline constexpr std::array<std::string_view, 7> kSelectionKeys = {"box", "sphere", "capsule", "vertices", "group", "all", "selection"};
/// These and the given ones.
std::vector<std::string_view> with_selection_keys(std::initializer_list<std::string_view> keys);

/// Material of the body and of its regions: def.material, its arrays per element, def.regions.
void read_materials(const JsonNode& body, BodyDef& def);

}  // namespace supple::io
