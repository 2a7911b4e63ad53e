#include <algorithm>

#include "supple/io/scene_parts.h"
#include "supple/io/text_scanner.h"

namespace supple::io {

namespace {

std::string_view only_key(const JsonNode& node, std::span<const std::string_view> keys, const std::string& missing) {
    std::string_view found;
    for (std::string_view key : keys) {
        if (!node.has(key)) continue;
        if (!found.empty()) node.at(key).fail(quoted(key) + " and " + quoted(found) + " exclude each other; keep one");
        found = key;
    }
    if (found.empty()) node.fail(missing);
    return found;
}

Selection read_selection_key(const JsonNode& node, std::string_view key, const VolumeMesh& mesh) {
    const JsonNode value = node.at(key);
    if (key == "selection") {
        if (value.has("selection")) value.at("selection").fail("a selection cannot hold another \"selection\"; write it directly");
        if (value.is_object()) value.require_object(kSelectionKeys);
        return read_selection(value, mesh);
    }
    if (key == "all") {
        if (!value.boolean()) value.fail("must be true; leave the key out to select nothing");
        return Everything{};
    }
    if (key == "box") {
        value.require_object({"min_m", "max_m"});
        return read_box(value, true);
    }
    if (key == "sphere") {
        value.require_object({"centre_m", "radius_m"});
        return InsideSphere{value.at("centre_m").vec3(), value.at("radius_m").number(0, 1e9)};
    }
    if (key == "capsule") {
        value.require_object({"a_m", "b_m", "radius_m"});
        return InsideCapsule{value.at("a_m").vec3(), value.at("b_m").vec3(), value.at("radius_m").number(0, 1e9)};
    }
    if (key == "group") return InGroup{value.text()};
    VertexList list;
    if (!value.is_array()) value.fail("must be a list of vertex numbers, counted from 0, found " + value.shown());
    for (std::size_t i = 0; i < value.size(); ++i) {
        list.vertices.push_back(std::int32_t(value.item(i).integer(0, std::int64_t(mesh.vertices.size()) - 1)));
    }
    return list;
}

Axes read_axes(const JsonNode& node) {
    if (!node.has("axes")) return {};
    const JsonNode value = node.at("axes");
    const std::string word = value.text();
    Axes axes{false, false, false};
    for (char c : word) {
        bool* axis = c == 'x' ? &axes.x : c == 'y' ? &axes.y : c == 'z' ? &axes.z : nullptr;
        if (!axis || *axis) value.fail(value.shown() + " must hold some of the letters x, y and z, each once");
        *axis = true;
    }
    if (word.empty()) value.fail("is empty; name at least one of x, y and z, or leave the key out for all three");
    return axes;
}

struct Vec3Value {
    using Type = Vec3;
    static constexpr const char* kSingle = "[x, y, z]";
    static Type read(const JsonNode& node) { return node.vec3(1e15); }
    static Type neutral() { return Vec3::Zero(); }
    static bool is_list(const JsonNode& node) { return node.is_array() && node.size() > 0 && node.item(0).is_array(); }
};

struct ScalarValue {
    using Type = double;
    static constexpr const char* kSingle = "number";
    static Type read(const JsonNode& node) { return node.number(-1e15, 1e15); }
    static Type neutral() { return 0; }
    static bool is_list(const JsonNode& node) { return node.is_array(); }
};

struct AffineValue {
    using Type = Mat34;
    static constexpr const char* kSingle = "three rows of four numbers";
    static Type read(const JsonNode& node) {
        Mat34 map;
        if (!node.is_array() || node.size() != 3) node.fail("must be three rows of four numbers [A | t], found " + node.shown());
        for (std::size_t r = 0; r < 3; ++r) {
            const JsonNode row = node.item(r);
            if (!row.is_array() || row.size() != 4) row.fail("must be a row of four numbers, found " + row.shown());
            for (std::size_t c = 0; c < 4; ++c) map(Eigen::Index(r), Eigen::Index(c)) = row.item(c).number(-1e15, 1e15);
        }
        return map;
    }
    static Type neutral() { return Mat34::Identity(); }
    static bool is_list(const JsonNode& node) { return Vec3Value::is_list(node) && Vec3Value::is_list(node.item(0)); }
};

/// The value under `key` with the entry's times_s, as scene.h says.
template <class Value>
Timeline<typename Value::Type> read_timeline(const JsonNode& entry, std::string_view key) {
    const JsonNode value = entry.at(key);
    Timeline<typename Value::Type> timeline;
    if (!entry.has("times_s")) {
        if (Value::is_list(value))
            value.fail("is a list of values, but \"times_s\" is missing; give one time per value, or one value " +
                       std::string(Value::kSingle));
        timeline.values.push_back(Value::read(value));
        return timeline;
    }
    const JsonNode times = entry.at("times_s");
    for (const JsonNode& time : times.items()) {
        const double t = time.number();
        if (!timeline.times_s.empty() && t <= timeline.times_s.back())
            time.fail(time.shown() + " s does not come after the time before it; times must ascend");
        timeline.times_s.push_back(t);
    }
    if (timeline.times_s.empty()) times.fail("is empty; give at least one time, or leave the key out for a constant value");
    if (!Value::is_list(value)) {
        if (timeline.times_s.size() != 2) {
            value.fail("is a single value with " + std::to_string(timeline.times_s.size()) +
                       " times; give a list with one value per time, or two times for a ramp to the value");
        }
        timeline.values = {Value::neutral(), Value::read(value)};
        return timeline;
    }
    if (value.size() != timeline.times_s.size()) {
        value.fail("has " + std::to_string(value.size()) + " values for " + std::to_string(timeline.times_s.size()) +
                   " times; give one value per time");
    }
    for (std::size_t i = 0; i < value.size(); ++i) timeline.values.push_back(Value::read(value.item(i)));
    return timeline;
}

Motion read_motion(const JsonNode& node, const VolumeMesh& mesh) {
    require_keys(node, with_selection_keys({"axes", "displacement_m", "velocity_m_s", "affine", "times_s"}));
    Motion motion;
    motion.where = read_selection(node, mesh);
    motion.axes = read_axes(node);
    static constexpr std::string_view kKinds[] = {"displacement_m", "velocity_m_s", "affine"};
    const std::string_view key = only_key(node, kKinds, "a motion needs one of \"displacement_m\", \"velocity_m_s\" and \"affine\"");
    if (key == "displacement_m") motion.displacement_m = read_timeline<Vec3Value>(node, key);
    if (key == "velocity_m_s") motion.velocity_m_s = read_timeline<Vec3Value>(node, key);
    if (key == "affine") motion.affine = read_timeline<AffineValue>(node, key);
    return motion;
}

/// Whether a boundary triangle has all its vertices selected.
bool touches_boundary(const BodyTemplate& shape, const Selection& where) {
    std::vector<bool> selected(shape.mesh().vertices.size(), false);
    for (std::int32_t v : select_vertices(shape.mesh(), where)) selected[std::size_t(v)] = true;
    const auto& triangles = shape.boundary().triangles;
    return std::any_of(triangles.begin(), triangles.end(), [&](const Triangle& t) {
        return selected[std::size_t(t[0])] && selected[std::size_t(t[1])] && selected[std::size_t(t[2])];
    });
}

struct LoadWord {
    std::string_view key;
    LoadKind kind;
    bool vector_valued, on_triangles, may_follow;
};
constexpr LoadWord kLoadWords[] = {
    {"force_n", LoadKind::total_force, true, false, false},   {"force_per_vertex_n", LoadKind::force_per_vertex, true, false, false},
    {"traction_pa", LoadKind::traction, true, true, false},   {"pressure_pa", LoadKind::pressure, false, true, true},
    {"moment_nm", LoadKind::moment, false, true, true},       {"body_force_n_m3", LoadKind::body_force, true, false, false},
};

void read_site(const JsonNode& node, const LoadWord& word, const BodyTemplate& shape, Load& load) {
    if (!node.has("triangles")) {
        load.where = read_selection(node, shape.mesh());
        if ((word.kind == LoadKind::traction || word.kind == LoadKind::pressure) && !touches_boundary(shape, load.where))
            node.at(word.key).fail("no boundary triangle has all its vertices in the selection; make the selection larger");
        if (word.kind == LoadKind::body_force && select_elements(shape.mesh(), load.where).empty())
            node.at(word.key).fail("no element has all its vertices in the selection; make the selection larger");
        return;
    }
    const JsonNode list = node.at("triangles");
    for (std::string_view key : kSelectionKeys)
        if (node.has(key)) node.at(key).fail(quoted(key) + " and \"triangles\" exclude each other; keep one");
    if (!word.on_triangles) list.fail("belongs to traction_pa, pressure_pa and moment_nm; select vertices for " + std::string(word.key));
    for (const JsonNode& t : list.items()) load.triangles.push_back(std::int32_t(t.integer(0, std::int64_t(shape.boundary().triangles.size()) - 1)));
    if (load.triangles.empty()) list.fail("is empty; name boundary triangles by their numbers, counted from 0");
}

Load read_load(const JsonNode& node, const BodyTemplate& shape) {
    std::vector<std::string_view> keys = with_selection_keys({"triangles", "follower", "axis", "times_s"}), kinds;
    std::string named;
    for (const LoadWord& word : kLoadWords) {
        kinds.push_back(word.key);
        named += (named.empty() ? "" : ", ") + quoted(word.key);
    }
    keys.insert(keys.end(), kinds.begin(), kinds.end());
    require_keys(node, keys);
    const std::string_view key = only_key(node, kinds, "a load needs one of " + named);
    const LoadWord& word = *std::find_if(std::begin(kLoadWords), std::end(kLoadWords), [&](const LoadWord& w) { return w.key == key; });
    Load load;
    load.kind = word.kind;
    read_site(node, word, shape, load);
    if (word.vector_valued) {
        load.value = read_timeline<Vec3Value>(node, key);
    } else {
        load.amount = read_timeline<ScalarValue>(node, key);
    }
    if (node.has("follower")) {
        if (!word.may_follow) node.at("follower").fail("belongs to pressure_pa and moment_nm; " + std::string(key) + " keeps its direction");
        load.follower = node.at("follower").boolean();
    }
    if (word.kind == LoadKind::moment) {
        load.axis = node.at("axis", "a moment turns about an axis: give its direction, [x, y, z]").vec3(1e15);
        if (!(load.axis.norm() > 0)) node.at("axis").fail("has no direction; give a vector of any length but zero");
    } else if (node.has("axis")) {
        node.at("axis").fail("belongs to moment_nm");
    }
    return load;
}

}  // namespace

std::vector<std::string_view> with_selection_keys(std::initializer_list<std::string_view> keys) {
    std::vector<std::string_view> all(kSelectionKeys.begin(), kSelectionKeys.end());
    all.insert(all.end(), keys);
    return all;
}

Selection read_selection(const JsonNode& node, const VolumeMesh& mesh) {
    Selection selection = Everything{};
    if (node.is_string()) {
        if (node.text() != "all") node.fail(node.shown() + " is no selection; write \"all\" or {\"group\": " + node.shown() + "}");
        return selection;
    }
    if (!node.is_object()) {
        node.fail("must be \"all\" or an object with one of \"box\", \"sphere\", \"capsule\", \"vertices\", \"group\" and \"all\", found " +
                  node.shown());
    }
    const std::string_view key = only_key(
        node, kSelectionKeys, "a selection is missing; give one of \"box\", \"sphere\", \"vertices\", \"group\" and \"all\": true");
    selection = read_selection_key(node, key, mesh);
    std::vector<std::int32_t> vertices;
    try {
        vertices = select_vertices(mesh, selection);
    } catch (const Error& error) {
        node.at(key).fail(error.message());
    }
    if (!vertices.empty()) return selection;
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    if (!mesh.vertices.empty()) low = high = mesh.vertices[0];
    for (const Vec3& x : mesh.vertices) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    const auto corner = [](const Vec3& x) { return std::string("[") + to_text(x[0]) + ", " + to_text(x[1]) + ", " + to_text(x[2]) + "]"; };
    node.at(key).fail("selects no vertex; the rest shape, scaled, reaches from " + corner(low) + " to " + corner(high) + " m");
}

void read_supports_and_loads(const JsonNode& node, SceneBody& body) {
    const BodyTemplate& shape = *body.def.shape;
    if (node.has("fixed")) {
        for (const JsonNode& entry : node.at("fixed").items()) {
            if (entry.is_object()) require_keys(entry, with_selection_keys({"axes"}));
            body.fixed.push_back({read_selection(entry, shape.mesh()), read_axes(entry)});
        }
    }
    if (node.has("prescribed")) {
        for (const JsonNode& entry : node.at("prescribed").items()) body.prescribed.push_back(read_motion(entry, shape.mesh()));
    }
    if (node.has("loads")) {
        for (const JsonNode& entry : node.at("loads").items()) body.loads.push_back(read_load(entry, shape));
    }
}

}  // namespace supple::io
