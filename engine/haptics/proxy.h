#pragma once
#include "supple/haptics/local_model.h"

namespace supple::haptics {

/// The tool's shape as it is felt: held by the coupling to the handle, kept outside the bodies by the contacts of a local model.
///
/// Without mass: p = x + sum r_j / k. With it the contacts read  s_i = gap_i n_i + (x - tool) - v_i t + sum_j (W_ij + I/k) r_j - W_ij force_j,
/// n.s >= 0, n.r >= 0, one of them zero; across the normal what sticks does not move, what slides has |r_t| = mu n.r (projected Gauss-Seidel over the contacts).
/// @source the scheme of implicit intermediate models: Otaduy and Gross 2007, Transparent rendering of tool contact with compliant environments; Peterlik et al. 2011
class Proxy {
public:
    /// Takes a model over, with the forces that its simulation had.
    void adopt(const LocalModel& model) noexcept;
    void forget() noexcept { model_.contacts = 0; }

    /// Solves for the handle at x [scene]. @param age_s  since the model's moment, at most a step of it is used
    /// @param stiffness_n_m  of the coupling, scene
    /// @return the force on the tool, scene
    Vec3 solve(const Vec3& x, double stiffness_n_m, double age_s) noexcept;
    /// What slid has slid: the tick is over.
    void settle() noexcept;

    const Vec3& position_m() const noexcept { return p_; }
    const LocalModel& model() const noexcept { return model_; }
    std::size_t touching() const noexcept { return touching_; }
    int sweeps() const noexcept { return sweeps_; }
    /// Most that a contact is inside the body after the solve: what the iteration left [m].
    double penetration_m() const noexcept { return penetration_; }

private:
    LocalModel model_;
    std::array<Vec3, kMostLocalContacts> r_{}, s_{}, anchor_{};
    Vec3 p_ = Vec3::Zero();
    std::size_t touching_ = 0;
    int sweeps_ = 0;
    double penetration_ = 0;
};

}  // namespace supple::haptics
