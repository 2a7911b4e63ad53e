#pragma once
#include <cmath>
#include <vector>

#include "supple/render/gl_objects.h"
#include "supple/render/normals.h"
#include "supple/render/occlusion.h"
#include "supple/render/scene_frame.h"

namespace supple::render {

/// What the vertex shader of surfaces reads; corners and shapes share it.
struct SurfaceVertex {
    Eigen::Vector3f position, normal;
    float scalar = 0, openness = 1;
};

/// One surface on its way to the graphics card. Topology (creases, indices) is rebuilt only when the triangles change.
class SurfaceBuffers {
public:
    /// Checks the view, moves its points to the scene frame and computes the normals.
    /// @param name  for messages, e.g. "FrameView.surfaces[2]"
    /// @error Error(invalid_argument) for sizes that disagree, indices out of range, or positions that are not finite
    void prepare(const SurfaceView& view, const SceneFrame& frame, const std::string& name);
    void add_to(OcclusionGrid& grid) const;
    void occlude(const OcclusionGrid& grid);
    void upload();

    void draw() const;        ///< triangles
    void draw_edges() const;  ///< lines of SurfaceView::edges
    void bind_values(int unit) const;  ///< of SurfaceView::triangle_scalar, as a buffer texture
    bool has_edges() const { return edge_indices_ > 0; }
    bool has_grain() const { return has_reference_; }
    bool has_inner() const { return has_inner_; }

    const std::vector<SurfaceVertex>& vertices() const { return vertices_; }
    const SmoothTopology& topology() const { return topology_; }
    std::size_t triangle_count() const { return topology_.triangles.size(); }

    /// Ends of the lines of the rest outline: its contour as the eye sees it, and its crisp edges.
    void append_rest_outline(const SurfaceView& view, const SceneFrame& frame, const Eigen::Vector3f& eye,
                             std::vector<Eigen::Vector3f>& lines) const;

private:
    void rebuild_topology(const SurfaceView& view, const std::string& name);
    void upload_edges(const SurfaceView& view, const std::string& name);

    struct Key {
        const void* data = nullptr;
        std::size_t size = 0;
        std::uint64_t hash = 0;
        bool operator==(const Key&) const = default;
    };
    Key topology_key_, inner_key_, edges_key_;
    double crease_angle_deg_ = -1;
    std::size_t vertex_count_ = 0;
    bool has_reference_ = false, has_inner_ = false;

    SmoothTopology topology_;
    std::vector<std::uint32_t> corner_of_;  // per vertex of the user: one of its corners
    std::vector<SurfaceVertex> vertices_;
    std::vector<Eigen::Vector3f> positions_, normals_;

    VertexArray array_, edge_array_;
    Buffer vertex_buffer_, index_buffer_, reference_buffer_, inner_buffer_, edge_buffer_;
    std::size_t edge_indices_ = 0;
    std::vector<float> values_;
    Buffer value_buffer_;
    Texture value_texture_;
};

/// A number on its way to a shader, which draws what is not finite in grey.
inline float shader_value(double value) { return std::isfinite(value) ? float(value) : -1e38f; }

/// Describes SurfaceVertex to the vertex array that is bound, from the buffer that is bound.
void describe_surface_vertex();

}  // namespace supple::render
