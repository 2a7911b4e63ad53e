#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "supple/contact/shape.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::contact {

/// The inside of a closed surface as signed distances on a grid, linear between its nodes: what a mesh is to contact.
///
/// Distances are exact at the nodes (nearest point of the triangles). A node is inside where the surface winds around it: crossings are counted with their
/// sign along the grid lines of each axis, and two of the three must agree, so overlapping parts and single bad triangles do no harm. Same bits everywhere.
class DistanceGrid {
public:
    /// @param triangles  closed: every edge has its opposite, vertices at the same place count as one; outward counter-clockwise or inward (turned around)
    /// @param cells      along the longest side, 8..256. Features below a cell are lost; memory grows with the cube: 64 takes about 1 MB
    /// @error Error(invalid_argument) at `name`: not closed, no volume, ids or numbers out of range
    static std::shared_ptr<const DistanceGrid> build(std::span<const Vec3> vertices, std::span<const Triangle> triangles, const std::string& name = "mesh",
                                                     int cells = 64);

    /// Beyond the grid (2.5 cells around the surface) d is a lower bound, the normal points away from the grid.
    Distance distance(const Vec3& p) const;
    const Bounds& bounds() const { return bounds_; }     ///< of the surface
    double depth_m() const { return depth_m_; }          ///< of the node farthest inside
    double spacing_m() const { return spacing_; }
    const MassProperties& mass_properties() const { return mass_; }
    /// The surface itself, welded: for pictures.
    const std::vector<Vec3>& vertices() const { return vertices_; }
    const std::vector<Triangle>& triangles() const { return triangles_; }

private:
    DistanceGrid() = default;
    void weld(std::span<const Vec3> vertices, std::span<const Triangle> triangles, const std::string& name);
    void measure(const std::string& name);
    void fill_distances();
    void sign_distances();

    double at(std::size_t i, std::size_t j, std::size_t k) const { return double(value_[(k * nodes_[1] + j) * nodes_[0] + i]); }

    std::vector<Vec3> vertices_;
    std::vector<Triangle> triangles_;
    Bounds bounds_;
    MassProperties mass_;
    double depth_m_ = 0, spacing_ = 1;
    Vec3 origin_ = Vec3::Zero();
    std::array<std::size_t, 3> nodes_{};
    std::vector<float> value_;  ///< [z][y][x] signed distance [m]
};

}  // namespace supple::contact
