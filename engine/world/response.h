#pragma once
#include <memory>
#include <span>
#include <vector>

#include "supple/world/inspect.h"

namespace supple {

/// How a body answers small forces over a step, as the last step left it: with its matrix A = (1 + h alpha) M + (h^2 + h beta) K, held coordinates out of it, and
/// the contacts and attachments that pressed, as springs between the body and what does not move. Forces df [N] from now on move it by h^2 A^-1 df [m] (static: K^-1 df). Drag springs and the wide
/// part of nearly incompressible tetrahedra (nodal volumes) are left out: there it is a little too soft.
/// Reads the world only; valid until the world's next step or edit. float64.
class BodyResponse {
public:
    /// @param without  a collider whose contacts and attachments are left out: the one whose force is asked about
    /// @error Error(stale_id); Error(invalid_argument) before the body's first step
    BodyResponse(const World& world, BodyId body, ColliderId without = {});
    ~BodyResponse();
    BodyResponse(const BodyResponse&) = delete;
    BodyResponse& operator=(const BodyResponse&) = delete;

    std::size_t vertices() const;
    /// h^2 as above [s^2].
    double scale() const;
    bool is_free(std::int32_t vertex, int axis) const;  ///< that coordinate is not held

    /// Vertices around `seeds`, nearest by edges first (the seeds themselves, then rings), at most `most`. Ascending.
    std::vector<std::int32_t> patch(std::span<const std::int32_t> seeds, std::size_t most) const;
    /// A of some vertices, 3 rows each: what lies beyond them stays where it is.
    void submatrix(std::span<const std::int32_t> vertices, MatX& A) const;

    struct Solved {
        int iterations = 0;
        double relative_residual = 0;
    };
    /// Displacements of all vertices under forces on them, by conjugate gradients.
    /// @param displacement_m  in: a guess; out. One per vertex, as force_n
    Solved solve(std::span<const Vec3> force_n, std::span<Vec3> displacement_m, double relative_tolerance = 1e-3, int max_iterations = 1000) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace supple
