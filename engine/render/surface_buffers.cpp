#include "supple/render/surface_buffers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "supple/base/error.h"

namespace supple::render {

using Eigen::Vector3f;

namespace {

/// FNV-1a over 64-bit words: tells one list of indices from another, nothing more.
template <class T>
std::uint64_t hash_of(std::span<const T> items) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(items.data());
    std::uint64_t hash = 0xcbf29ce484222325u, word = 0;
    std::size_t n = items.size_bytes(), i = 0;
    for (; i + 8 <= n; i += 8) {
        std::memcpy(&word, bytes + i, 8);
        hash = (hash ^ word) * 0x100000001b3u;
        hash ^= hash >> 29;
    }
    word = 0;
    if (i < n) std::memcpy(&word, bytes + i, n - i);
    return (hash ^ word) * 0x100000001b3u;
}

[[noreturn]] void refuse(const std::string& where, const std::string& what) { throw Error(ErrorCode::invalid_argument, where, what); }

void require_size(std::size_t size, std::size_t vertices, const std::string& where) {
    if (size != 0 && size != vertices)
        refuse(where, "has " + std::to_string(size) + " values for " + std::to_string(vertices) + " positions; give one each, or none");
}

}  // namespace

void describe_surface_vertex() {
    const auto attribute = [](GLuint index, GLint size, std::size_t offset) {
        glEnableVertexAttribArray(index);
        glVertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, sizeof(SurfaceVertex), reinterpret_cast<const void*>(offset));
    };
    attribute(0, 3, offsetof(SurfaceVertex, position));
    attribute(1, 3, offsetof(SurfaceVertex, normal));
    attribute(2, 2, offsetof(SurfaceVertex, scalar));
}

void SurfaceBuffers::prepare(const SurfaceView& view, const SceneFrame& frame, const std::string& name) {
    require_size(view.scalar.size(), view.positions.size(), name + ".scalar");
    require_size(view.rest_positions.size(), view.positions.size(), name + ".rest_positions");
    require_size(view.reference_positions.size(), view.positions.size(), name + ".reference_positions");
    if (!view.triangle_scalar.empty() && view.triangle_scalar.size() != view.triangles.size())
        refuse(name + ".triangle_scalar", "has " + std::to_string(view.triangle_scalar.size()) + " values for " + std::to_string(view.triangles.size()) +
                                              " triangles; give one each, or none");
    if (!view.inner.empty() && view.inner.size() != view.triangles.size())
        refuse(name + ".inner", "has " + std::to_string(view.inner.size()) + " values for " + std::to_string(view.triangles.size()) + " triangles; give one each, or none");
    if (!view.triangle_scalar.empty() && !view.scalar.empty()) refuse(name + ".triangle_scalar", "and scalar exclude each other; leave one empty");
    if (!(view.opacity > 0 && view.opacity <= 1)) refuse(name + ".opacity", to_text(view.opacity) + " is outside (0, 1]; leave the surface out to hide it");
    require_in_range(view.crease_angle_deg, 0, 180, name + ".crease_angle_deg", "40 keeps organs smooth and blocks crisp");

    const Key key{view.triangles.data(), view.triangles.size(), hash_of(view.triangles)};
    const bool has_reference = !view.reference_positions.empty();
    const Key inner_key{view.inner.data(), view.inner.size(), hash_of(view.inner)};
    if (!(key == topology_key_) || !(inner_key == inner_key_) || crease_angle_deg_ != view.crease_angle_deg || vertex_count_ != view.positions.size() ||
        has_reference != has_reference_) {
        topology_key_ = {};  // stays empty if the view is refused half way
        rebuild_topology(view, name);
        topology_key_ = key;
        inner_key_ = inner_key;
    }
    const Key edges_key{view.edges.data(), view.edges.size(), hash_of(view.edges)};
    if (!(edges_key == edges_key_)) {
        edges_key_ = {};
        upload_edges(view, name);
        edges_key_ = edges_key;
    }

    const std::size_t corners = topology_.vertex_of.size();
    positions_.resize(corners);
    for (std::size_t c = 0; c < corners; ++c) {
        const auto v = std::size_t(topology_.vertex_of[c]);
        positions_[c] = frame.point(view.positions[v]);
        if (!positions_[c].allFinite())
            refuse(name + ".positions", "vertex " + std::to_string(v) + " is not finite, or too far away to draw");
    }
    compute_normals(topology_, positions_, normals_);
    vertices_.resize(corners);
    for (std::size_t c = 0; c < corners; ++c) {
        vertices_[c].position = positions_[c];
        vertices_[c].normal = normals_[c];
        vertices_[c].openness = 1;
        const double value = view.scalar.empty() ? 0.0 : view.scalar[std::size_t(topology_.vertex_of[c])];
        vertices_[c].scalar = shader_value(value);
    }
    values_.resize(view.triangle_scalar.size());
    for (std::size_t t = 0; t < values_.size(); ++t) values_[t] = shader_value(view.triangle_scalar[t]);
}

void SurfaceBuffers::rebuild_topology(const SurfaceView& view, const std::string& name) {
    const auto count = std::int64_t(view.positions.size());
    for (std::size_t t = 0; t < view.triangles.size(); ++t)
        for (const std::int32_t v : view.triangles[t])
            if (v < 0 || v >= count)
                refuse(name + ".triangles",
                       "triangle " + std::to_string(t) + " names vertex " + std::to_string(v) + "; there are " + std::to_string(count));
    has_reference_ = !view.reference_positions.empty();
    topology_ = split_at_creases(has_reference_ ? view.reference_positions : view.positions, view.triangles, view.crease_angle_deg, view.inner);
    crease_angle_deg_ = view.crease_angle_deg;
    vertex_count_ = view.positions.size();
    edges_key_ = {};  // lines name corners, which have new numbers
    edge_indices_ = 0;
    corner_of_.assign(view.positions.size(), UINT32_MAX);
    for (std::size_t c = 0; c < topology_.vertex_of.size(); ++c) corner_of_[std::size_t(topology_.vertex_of[c])] = std::uint32_t(c);

    glBindVertexArray(array_.get());
    upload_buffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_, std::span<const std::array<std::uint32_t, 3>>(topology_.triangles),
                  GL_STATIC_DRAW);
    glBindBuffer(GL_ARRAY_BUFFER, vertex_buffer_.get());
    describe_surface_vertex();
    if (has_reference_) {
        // In units of the body's size: the grain is then as coarse on a kidney as on a whale.
        Vec3 low = Vec3::Constant(1e300), high = -low;
        for (const std::int32_t v : topology_.vertex_of) {
            low = low.cwiseMin(view.reference_positions[std::size_t(v)]);
            high = high.cwiseMax(view.reference_positions[std::size_t(v)]);
        }
        const double scale = 1 / std::max((high - low).norm(), 1e-300);
        std::vector<Vector3f> reference(topology_.vertex_of.size());
        for (std::size_t c = 0; c < reference.size(); ++c)
            reference[c] = ((view.reference_positions[std::size_t(topology_.vertex_of[c])] - low) * scale).cast<float>();
        upload_buffer(GL_ARRAY_BUFFER, reference_buffer_, std::span<const Vector3f>(reference), GL_STATIC_DRAW);
        glEnableVertexAttribArray(4);
        glVertexAttribPointer(4, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    } else {
        glDisableVertexAttribArray(4);
    }
    has_inner_ = std::any_of(view.inner.begin(), view.inner.end(), [](char i) { return i != 0; });
    if (has_inner_) {
        std::vector<float> inner(topology_.vertex_of.size(), 0.0f);  // a corner's triangles are all of one kind
        for (std::size_t t = 0; t < view.inner.size(); ++t)
            for (const std::uint32_t c : topology_.triangles[t]) inner[c] = view.inner[t] != 0 ? 1.0f : 0.0f;
        upload_buffer(GL_ARRAY_BUFFER, inner_buffer_, std::span<const float>(inner), GL_STATIC_DRAW);
        glEnableVertexAttribArray(5);
        glVertexAttribPointer(5, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
    } else {
        glDisableVertexAttribArray(5);
    }
    glBindVertexArray(0);
}

void SurfaceBuffers::upload_edges(const SurfaceView& view, const std::string& name) {
    std::vector<std::uint32_t> indices;
    indices.reserve(2 * view.edges.size());
    for (std::size_t e = 0; e < view.edges.size(); ++e) {
        std::uint32_t ends[2];
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int32_t v = view.edges[e][k];
            if (v < 0 || std::size_t(v) >= corner_of_.size())
                refuse(name + ".edges", "edge " + std::to_string(e) + " names vertex " + std::to_string(v) + "; there are " +
                                            std::to_string(corner_of_.size()));
            ends[k] = corner_of_[std::size_t(v)];
        }
        // Edges inside the body end at vertices of no triangle: they are never seen.
        if (ends[0] != UINT32_MAX && ends[1] != UINT32_MAX) indices.insert(indices.end(), {ends[0], ends[1]});
    }
    edge_indices_ = indices.size();
    if (indices.empty()) return;
    glBindVertexArray(edge_array_.get());
    upload_buffer(GL_ELEMENT_ARRAY_BUFFER, edge_buffer_, std::span<const std::uint32_t>(indices), GL_STATIC_DRAW);
    glBindBuffer(GL_ARRAY_BUFFER, vertex_buffer_.get());
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(SurfaceVertex), nullptr);
    glBindVertexArray(0);
}

void SurfaceBuffers::add_to(OcclusionGrid& grid) const {
    for (const auto& t : topology_.triangles) grid.add(positions_[t[0]], positions_[t[1]], positions_[t[2]]);
}

void SurfaceBuffers::occlude(const OcclusionGrid& grid) {
    for (SurfaceVertex& v : vertices_) v.openness = grid.openness(v.position, v.normal);
}

void SurfaceBuffers::upload() {
    upload_buffer(GL_ARRAY_BUFFER, vertex_buffer_, std::span<const SurfaceVertex>(vertices_), GL_STREAM_DRAW);
    if (!values_.empty()) upload_buffer(GL_TEXTURE_BUFFER, value_buffer_, std::span<const float>(values_), GL_STREAM_DRAW);
}

void SurfaceBuffers::bind_values(int unit) const {
    glActiveTexture(GL_TEXTURE0 + GLenum(unit));
    glBindTexture(GL_TEXTURE_BUFFER, value_texture_.get());
    glTexBuffer(GL_TEXTURE_BUFFER, GL_R32F, value_buffer_.get());
}

void SurfaceBuffers::draw() const {
    if (topology_.closed) glEnable(GL_CULL_FACE);
    glBindVertexArray(array_.get());
    glDrawElements(GL_TRIANGLES, GLsizei(3 * topology_.triangles.size()), GL_UNSIGNED_INT, nullptr);
    glDisable(GL_CULL_FACE);
}

void SurfaceBuffers::draw_edges() const {
    glBindVertexArray(edge_array_.get());
    glDrawElements(GL_LINES, GLsizei(edge_indices_), GL_UNSIGNED_INT, nullptr);
}

void SurfaceBuffers::append_rest_outline(const SurfaceView& view, const SceneFrame& frame, const Vector3f& eye,
                                         std::vector<Vector3f>& lines) const {
    if (view.rest_positions.empty()) return;
    const auto at = [&](std::int32_t v) { return frame.point(view.rest_positions[std::size_t(v)]); };
    std::vector<bool> towards(view.triangles.size());
    for (std::size_t t = 0; t < towards.size(); ++t) {
        const Vector3f a = at(view.triangles[t][0]), b = at(view.triangles[t][1]), c = at(view.triangles[t][2]);
        towards[t] = (b - a).cross(c - a).dot(eye - a) > 0;
    }
    for (const SmoothTopology::Edge& e : topology_.edges) {
        const bool contour = e.other < 0 || towards[std::size_t(e.triangle)] != towards[std::size_t(e.other)];
        if (contour || e.crisp) lines.insert(lines.end(), {at(e.a), at(e.b)});
    }
}

}  // namespace supple::render
