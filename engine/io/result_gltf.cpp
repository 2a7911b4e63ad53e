// Results as an animated glTF 2.0 file (Khronos, "glTF 2.0 Specification"): a mesh per body, a morph target per frame after the first, and
// weights that go from each target to the next, linearly, at the frames' times. A body whose mesh is edited on the way has a mesh per mesh it had: each is seen (scale 1)
// from its first frame to the next one's, and has no size otherwise. Everything lies in one buffer, float32 and uint32.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "supple/io/base64.h"
#include "supple/io/binary_file.h"
#include "supple/io/binary_scanner.h"
#include "supple/io/result_parts.h"

namespace supple::io {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr int kFloat = 5126, kUint32 = 5125;                // componentType
constexpr int kVertexBuffer = 34962, kIndexBuffer = 34963;  // bufferView.target

using Vec3f = std::array<float, 3>;

std::vector<Vec3f> normals_of(const std::vector<Vec3>& x, const std::vector<Triangle>& triangles) {
    std::vector<Vec3> sums(x.size(), Vec3::Zero());
    for (const Triangle& t : triangles) {
        const Vec3 n = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
        for (const std::int32_t v : t) sums[v] += n;
    }
    std::vector<Vec3f> out;
    for (const Vec3& n : sums) {
        const double length = n.norm();
        const Vec3 unit = length > 0 ? Vec3(n / length) : Vec3(0, 1, 0);
        out.push_back({float(unit.x()), float(unit.y()), float(unit.z())});
    }
    return out;
}

std::vector<Vec3f> to_float(const std::vector<Vec3>& x) {
    std::vector<Vec3f> out;
    for (const Vec3& p : x) out.push_back({float(p.x()), float(p.y()), float(p.z())});
    return out;
}

/// a - b in float32, so that b plus it gives a back to rounding.
std::vector<Vec3f> difference(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
    std::vector<Vec3f> out;
    for (std::size_t i = 0; i < a.size(); ++i) out.push_back({a[i][0] - b[i][0], a[i][1] - b[i][1], a[i][2] - b[i][2]});
    return out;
}

/// The buffer with its views and accessors.
class Buffer {
public:
    int add(const std::vector<Vec3f>& values, bool bounds) {
        const int view = begin_view(kVertexBuffer);
        for (const Vec3f& v : values)
            for (const float f : v) numbers_.add(f);
        json accessor = end_view(view, kFloat, values.size(), "VEC3");
        if (bounds && !values.empty()) {
            Vec3f low = values[0], high = values[0];
            for (const Vec3f& v : values)
                for (int i = 0; i < 3; ++i) {
                    low[i] = std::min(low[i], v[i]);
                    high[i] = std::max(high[i], v[i]);
                }
            accessor["min"] = low;
            accessor["max"] = high;
        }
        return keep(std::move(accessor));
    }
    int add(const std::vector<float>& values, bool bounds) {
        const int view = begin_view(0);
        for (const float f : values) numbers_.add(f);
        json accessor = end_view(view, kFloat, values.size(), "SCALAR");
        if (bounds && !values.empty()) {
            accessor["min"] = {*std::min_element(values.begin(), values.end())};
            accessor["max"] = {*std::max_element(values.begin(), values.end())};
        }
        return keep(std::move(accessor));
    }
    int add(const std::vector<Triangle>& triangles) {
        const int view = begin_view(kIndexBuffer);
        for (const Triangle& t : triangles)
            for (const std::int32_t v : t) numbers_.add(std::uint32_t(v));
        return keep(end_view(view, kUint32, 3 * triangles.size(), "SCALAR"));
    }

    const std::string& bytes() const { return bytes_; }
    void describe(json& document) const {
        document["bufferViews"] = views_;
        document["accessors"] = accessors_;
    }

private:
    int begin_view(int target) {
        json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}};
        if (target != 0) view["target"] = target;
        views_.push_back(std::move(view));
        return int(views_.size()) - 1;
    }
    json end_view(int view, int component, std::size_t count, const char* type) {
        views_[view]["byteLength"] = bytes_.size() - views_[view]["byteOffset"].get<std::size_t>();
        return {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
    }
    int keep(json accessor) {
        accessors_.push_back(std::move(accessor));
        return int(accessors_.size()) - 1;
    }

    std::string bytes_;
    BinaryText numbers_{bytes_};
    json views_ = json::array(), accessors_ = json::array();
};

class GltfExport final : public ResultExport {
public:
    explicit GltfExport(fs::path file) : file_(std::move(file)) {}

    void add_frame(const World& world) override {
        if (times_.empty()) begin(world);
        const std::vector<BodyId> bodies = world.bodies();
        if (bodies.size() != now_.size())
            throw Error(ErrorCode::unsupported, file_.string(), "a body was added or removed during the animation; end it before");
        for (std::size_t b = 0; b < bodies.size(); ++b)
            if (world.edit_count(bodies[b]) != parts_[now_[b]].edits) begin_part(world, b);
        times_.push_back(float(world.time_s()));
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            const auto positions = world.positions(bodies[b]);
            Part& part = parts_[now_[b]];
            std::vector<Vec3> x;
            for (const std::int32_t v : part.surface.vertices) x.push_back(positions[std::size_t(v)]);
            part.frames.push_back(to_float(x));
            part.normals.push_back(normals_of(x, part.surface.triangles));
        }
    }

    void finish() override {
        Buffer buffer;
        json document = {{"asset", {{"version", "2.0"}, {"generator", "supple"}}}, {"scene", 0}};
        json meshes = json::array(), nodes = json::array(), materials = json::array(), children = json::array();
        json samplers = json::array(), channels = json::array();
        for (std::size_t b = 0; b < now_.size(); ++b) materials.push_back(material_of(b));
        std::map<std::pair<std::size_t, std::size_t>, int> sampler_of;  // frames from, to: bodies that were never edited share one
        const auto animate = [&](int node, const char* path, int sampler) {
            channels.push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
        };
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            const Part& part = parts_[p];
            const int node = int(p) + 1;  // 0 is the root
            const std::size_t from = part.first_frame, to = from + part.frames.size();
            meshes.push_back(mesh_of(buffer, part, int(part.body)));
            nodes.push_back({{"mesh", int(p)}, {"name", part.name}});
            children.push_back(node);
            if (to - from > 1) {
                const auto [sampler, is_new] = sampler_of.try_emplace({from, to}, int(samplers.size()));
                if (is_new) {
                    const int time = buffer.add(std::vector<float>(times_.begin() + std::ptrdiff_t(from), times_.begin() + std::ptrdiff_t(to)), true);
                    samplers.push_back({{"input", time}, {"output", buffer.add(weight_table(to - from), false)}, {"interpolation", "LINEAR"}});
                }
                animate(node, "weights", sampler->second);
            }
            if (to - from == times_.size()) continue;
            std::vector<float> when{times_[0]};
            std::vector<Vec3f> scale{from == 0 ? kSeen : kGone};
            if (from > 0) {
                when.push_back(times_[from]);
                scale.push_back(kSeen);
            }
            if (to < times_.size()) {
                when.push_back(times_[to]);
                scale.push_back(kGone);
            }
            const int time = buffer.add(when, true);
            samplers.push_back({{"input", time}, {"output", buffer.add(scale, false)}, {"interpolation", "STEP"}});
            animate(node, "scale", int(samplers.size()) - 1);
            if (from > 0) nodes.back()["scale"] = kGone;
        }
        nodes.insert(nodes.begin(), json{{"name", "world"}, {"children", children}, {"rotation", rotation_}});
        document["scenes"] = {{{"nodes", {0}}}};
        document["nodes"] = nodes;
        document["meshes"] = meshes;
        document["materials"] = materials;
        if (!channels.empty()) document["animations"] = {{{"name", "simulation"}, {"samplers", samplers}, {"channels", channels}}};
        buffer.describe(document);
        write(document, buffer.bytes());
    }

private:
    struct Part {
        std::string name;
        std::size_t body = 0;
        BodySurface surface;
        std::uint64_t edits = 0;      ///< of the body when this was its mesh
        std::size_t first_frame = 0;
        std::vector<std::vector<Vec3f>> frames = {}, normals = {};
    };
    static constexpr Vec3f kSeen{1, 1, 1}, kGone{0, 0, 0};

    /// A mesh of its own from the next frame on.
    void begin_part(const World& world, std::size_t body) {
        const BodyId id = world.bodies()[body];
        std::string name = world.name(id);
        if (!times_.empty()) name += ", edit " + std::to_string(world.edit_count(id));
        now_[body] = parts_.size();
        parts_.push_back({std::move(name), body, body_surface(world.shape(id)), world.edit_count(id), times_.size()});
    }

    void begin(const World& world) {
        now_.resize(world.bodies().size());
        for (std::size_t b = 0; b < now_.size(); ++b) begin_part(world, b);
        const Vec3 gravity = world.def().gravity_m_s2;
        const Vec3 up = gravity.norm() > 0 ? Vec3(-gravity.normalized()) : Vec3(0, 1, 0);
        const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(up, Vec3(0, 1, 0));
        rotation_ = {q.x(), q.y(), q.z(), q.w()};
    }

    static json material_of(std::size_t body) {
        static constexpr double kColours[][3] = {{0.72, 0.28, 0.24}, {0.30, 0.50, 0.70}, {0.80, 0.62, 0.30}, {0.40, 0.62, 0.42}};
        const auto& c = kColours[body % std::size(kColours)];
        return {
            {"pbrMetallicRoughness", {{"baseColorFactor", {c[0], c[1], c[2], 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.5}}}};
    }

    static json mesh_of(Buffer& buffer, const Part& part, int material) {
        json primitive = {{"attributes", {{"POSITION", buffer.add(part.frames[0], true)}, {"NORMAL", buffer.add(part.normals[0], false)}}},
                          {"indices", buffer.add(part.surface.triangles)},
                          {"material", material},
                          {"mode", 4}};
        json targets = json::array();
        for (std::size_t f = 1; f < part.frames.size(); ++f)
            targets.push_back({{"POSITION", buffer.add(difference(part.frames[f], part.frames[0]), true)},
                               {"NORMAL", buffer.add(difference(part.normals[f], part.normals[0]), false)}});
        json mesh = {{"name", part.name}};
        if (!targets.empty()) {
            mesh["weights"] = std::vector<double>(targets.size(), 0.0);
            primitive["targets"] = targets;
        }
        mesh["primitives"] = {primitive};
        return mesh;
    }

    /// Row by row of time: 1 for the frame's own target.
    static std::vector<float> weight_table(std::size_t frames) {
        const std::size_t targets = frames - 1;
        std::vector<float> table(frames * targets, 0.0f);
        for (std::size_t f = 1; f < frames; ++f) table[f * targets + f - 1] = 1;
        return table;
    }

    void write(json& document, const std::string& bytes) const {
        std::string ending = file_.extension().string();
        std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
        if (bytes.size() > 0xffff0000u)
            throw Error(ErrorCode::unsupported, file_.string(), "the animation has more than 4 GB; export fewer frames (--export-every)");
        json part = {{"byteLength", bytes.size()}};
        if (ending == ".gltf") {
            part["uri"] = "data:application/octet-stream;base64," + to_base64(bytes);
            document["buffers"] = {part};
            return write_text_file(file_, document.dump());
        }
        document["buffers"] = {part};
        std::string text = document.dump(), out = "glTF";
        text.resize((text.size() + 3) / 4 * 4, ' ');
        BinaryText numbers(out);
        for (const std::size_t n : {std::size_t(2), 12 + 8 + text.size() + 8 + bytes.size(), text.size()}) numbers.add(std::uint32_t(n));
        out += "JSON" + text;
        numbers.add(std::uint32_t(bytes.size()));  // all numbers are of four bytes: no padding is left to do
        out += std::string("BIN\0", 4) + bytes;
        write_text_file(file_, out);
    }

    fs::path file_;
    std::vector<float> times_;
    std::vector<Part> parts_;         ///< a mesh each, of all bodies, in the order they came
    std::vector<std::size_t> now_;    ///< [body] its part of the moment
    std::array<double, 4> rotation_{0, 0, 0, 1};
};

}  // namespace

std::unique_ptr<ResultExport> make_gltf_export(const fs::path& file) { return std::make_unique<GltfExport>(file); }

}  // namespace supple::io
