#pragma once
#include <vector>

#include "supple/render/surface_buffers.h"

namespace supple::render {

/// Spheres and arrows of one frame, collected into one draw call.
class Shapes {
public:
    void clear();
    void add_sphere(const Eigen::Vector3f& centre, float radius, const Eigen::Vector3f& linear_color);
    /// @param width  of the shaft; the head is three times as wide. Nothing is added where from and to agree.
    void add_arrow(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float width, const Eigen::Vector3f& linear_color);
    void upload();
    void draw() const;
    void draw_casters() const;  ///< the spheres only: arrows are annotations and cast no shadow
    const std::vector<SurfaceVertex>& vertices() const { return vertices_; }
    bool empty() const { return indices_.empty(); }

private:
    std::uint32_t add(const Eigen::Vector3f& position, const Eigen::Vector3f& normal);

    std::vector<SurfaceVertex> vertices_;
    std::vector<Eigen::Vector3f> colors_;
    std::vector<std::uint32_t> indices_;
    std::size_t caster_indices_ = 0;
    Eigen::Vector3f color_{1, 1, 1};
    VertexArray array_;
    Buffer vertex_buffer_, color_buffer_, index_buffer_;
};

}  // namespace supple::render
