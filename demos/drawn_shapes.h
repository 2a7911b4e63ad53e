#pragma once
#include <deque>
#include <span>
#include <vector>

#include "supple/mesh/triangle_mesh.h"
#include "supple/render/frame_view.h"

namespace supple::demos {

/// Things that are drawn beside the bodies and touch nothing: rods, bands, a blade. A view borrows from it until the next clear().
class DrawnShapes {
public:
    void clear() { shapes_.clear(); }
    /// A round tube along points, two or more, of one radius or of one per point [m]; its ends are closed.
    void tube(std::span<const Vec3> way, std::span<const double> radius_m, const std::array<float, 3>& color, Look look = Look::rubber);
    /// Any closed surface.
    void surface(mesh::TriangleMesh surface, const std::array<float, 3>& color, Look look = Look::metal, double opacity = 1);
    void add_to(FrameView& view) const;

private:
    struct Drawn {
        mesh::TriangleMesh mesh;
        std::array<float, 3> color;
        Look look;
        double opacity;
    };
    std::deque<Drawn> shapes_;
};

/// The solid between a strip from `a` to `b` (points of two polylines, as many in both) and its copy, `thickness_m` apart: a plate, a blade.
mesh::TriangleMesh thick_strip(std::span<const Vec3> a, std::span<const Vec3> b, double thickness_m);

}  // namespace supple::demos
