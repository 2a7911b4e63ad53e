#pragma once
#include <span>
#include <vector>

#include "supple/mesh/embedding.h"
#include "supple/mesh/opened_surface.h"

namespace supple::mesh {

/// Weights of a triangle's corners at the foot of a point on its plane.
std::array<double, 3> barycentric(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// What became of the elements of the mesh before.
class Hosts {
public:
    Hosts(const VolumeMesh& before, const MeshEdit& edit);
    bool lives(std::int32_t old) const { return first_[std::size_t(old)] < first_[std::size_t(old) + 1]; }
    /// The part of one of some old elements that a rest point lies in, or is least outside of; -1 where none lives.
    std::int32_t host(std::span<const std::int32_t> old, const Vec3& x) const;

private:
    const VolumeMesh& mesh_;
    std::vector<std::int32_t> first_, parts_;
};

/// A triangle of the skin to come.
struct SkinPiece {
    Triangle corner;                ///< points
    std::int32_t triangle = -1;     ///< of the skin before, or of the opened surface
    int lip = -1;                   ///< of the opened surface: which of the two; -1: of the skin
    bool gone = false;
    bool looked_at = true;          ///< of a triangle near what was laid open
    std::int32_t element = -1;      ///< behind it, where the cut says so: of a lip, and of skin at a line
};

/// A skin and what an edit of its mesh laid open, cut along their common lines.
struct SkinCut {
    TriangleMesh surface;               ///< at rest
    std::vector<std::int32_t> element;  ///< [vertex] that it is bound to
    std::vector<SkinPiece> pieces;      ///< [triangle]
    std::vector<Vec3> rest;             ///< [point]
    OpenedSurface opened;
};

/// @param embedding  of the skin in the mesh before
SkinCut cut_skin(const TriangleMesh& skin, const Embedding& embedding, const VolumeMesh& before, const MeshEdit& edit);

}  // namespace supple::mesh
