#include "supple/render/shapes.h"

#include <cmath>
#include <numbers>

namespace supple::render {

using Eigen::Vector3f;

void Shapes::clear() {
    vertices_.clear();
    colors_.clear();
    indices_.clear();
    caster_indices_ = 0;
}

std::uint32_t Shapes::add(const Vector3f& position, const Vector3f& normal) {
    vertices_.push_back({position, normal, 0, 1});
    colors_.push_back(color_);
    return std::uint32_t(vertices_.size() - 1);
}

void Shapes::add_sphere(const Vector3f& centre, float radius, const Vector3f& linear_color) {
    constexpr std::uint32_t kRings = 18, kSides = 36;
    color_ = linear_color;
    const auto first = std::uint32_t(vertices_.size());
    for (std::uint32_t r = 0; r <= kRings; ++r)
        for (std::uint32_t s = 0; s <= kSides; ++s) {
            const float polar = std::numbers::pi_v<float> * float(r) / kRings, turn = 2 * std::numbers::pi_v<float> * float(s) / kSides;
            const Vector3f n(std::sin(polar) * std::cos(turn), std::cos(polar), std::sin(polar) * std::sin(turn));
            add(centre + radius * n, n);
        }
    for (std::uint32_t r = 0; r < kRings; ++r)
        for (std::uint32_t s = 0; s < kSides; ++s) {
            const std::uint32_t a = first + r * (kSides + 1) + s, b = a + kSides + 1;
            indices_.insert(indices_.end(), {a, a + 1, b, a + 1, b + 1, b});
        }
    caster_indices_ = indices_.size();
}

void Shapes::add_arrow(const Vector3f& from, const Vector3f& to, float width, const Vector3f& linear_color) {
    constexpr int kSides = 20;
    const float length = (to - from).norm();
    if (!(length > 0)) return;
    color_ = linear_color;
    const Vector3f axis = (to - from) / length;
    const Vector3f u = axis.unitOrthogonal(), v = axis.cross(u);
    const float head = std::min(4.5f * width, 0.6f * length);  // a short arrow is mostly head, and gets thinner below that
    const float thickness = 0.5f * width * std::min(1.0f, head / (2.0f * width)), flare = 3 * thickness;
    const Vector3f neck = to - head * axis;

    // Each piece is a ring of quads between two radii: shaft, underside of the head, head; the start is closed by a disc.
    const auto band = [&](const Vector3f& c0, float r0, const Vector3f& c1, float r1) {
        const Vector3f along = c1 - c0;
        for (int s = 0; s < kSides; ++s) {
            std::uint32_t corner[4];
            for (int k = 0; k < 2; ++k) {
                const float turn = 2 * std::numbers::pi_v<float> * float(s + k) / kSides;
                const Vector3f out = std::cos(turn) * u + std::sin(turn) * v;
                // Normal of a cone: perpendicular to its flank.
                const Vector3f n = (out * along.dot(axis) - axis * (r1 - r0)).normalized();
                corner[k] = add(c0 + r0 * out, n);
                corner[k + 2] = add(c1 + r1 * out, n);
            }
            indices_.insert(indices_.end(), {corner[0], corner[1], corner[2], corner[1], corner[3], corner[2]});
        }
    };
    band(from, 0, from, thickness);
    band(from, thickness, neck, thickness);
    band(neck, thickness, neck, flare);
    band(neck, flare, to, 0);
}

void Shapes::upload() {
    if (indices_.empty()) return;
    glBindVertexArray(array_.get());
    upload_buffer(GL_ARRAY_BUFFER, vertex_buffer_, std::span<const SurfaceVertex>(vertices_), GL_STREAM_DRAW);
    describe_surface_vertex();
    upload_buffer(GL_ARRAY_BUFFER, color_buffer_, std::span<const Vector3f>(colors_), GL_STREAM_DRAW);
    glEnableVertexAttribArray(3);
    glVertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    upload_buffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_, std::span<const std::uint32_t>(indices_), GL_STREAM_DRAW);
}

void Shapes::draw() const {
    glBindVertexArray(array_.get());
    glDrawElements(GL_TRIANGLES, GLsizei(indices_.size()), GL_UNSIGNED_INT, nullptr);
}

void Shapes::draw_casters() const {
    glBindVertexArray(array_.get());
    glDrawElements(GL_TRIANGLES, GLsizei(caster_indices_), GL_UNSIGNED_INT, nullptr);
}

}  // namespace supple::render
