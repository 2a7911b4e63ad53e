#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "supple/math/types.h"

namespace supple::haptics {

inline constexpr std::size_t kMostLocalContacts = 24;

/// A place where a tool touches a body, or may do so before the next step.
struct LocalContact {
    Vec3 position_m = Vec3::Zero();  ///< of the body's surface
    Vec3 normal = Vec3(0, 1, 0);     ///< unit, out of the body
    double gap_m = 0;                ///< >= 0; what presses in the simulation touches exactly
    Vec3 force_n = Vec3::Zero();     ///< on the tool in the simulation
    Vec3 velocity_m_s = Vec3::Zero();///< of the surface
    double friction = 0;
    bool holds = false;              ///< the tool has taken hold of the point: it pulls as it pushes, and nothing slides
};

/// What a simulation tells a servo loop about the neighbourhood of its tool: with the tool at tool_m the contacts have these gaps and forces; where the forces
/// on the tool are others than these, r_j in place of force_j, the surface at contact i moves by - sum_j W_ij (r_j - force_j). W is the body's answer over a step of the simulation,
/// inertia included. Plain memory: it goes through a TripleBuffer.
struct LocalModel {
    std::uint64_t number = 0;  ///< counts up; 0: none yet
    double step_s = 0;         ///< of the simulation
    Vec3 tool_m = Vec3::Zero();
    std::size_t contacts = 0;  ///< <= kMostLocalContacts
    std::array<LocalContact, kMostLocalContacts> contact{};
    /// [m/N], symmetric: W_ij at (3 i, 3 j), row-major, rows of 3 contacts numbers.
    std::array<double, 9 * kMostLocalContacts * kMostLocalContacts> compliance{};

    double W(std::size_t row, std::size_t column) const noexcept { return compliance[row * 3 * contacts + column]; }
    double& W(std::size_t row, std::size_t column) noexcept { return compliance[row * 3 * contacts + column]; }
    bool finite() const noexcept {
        bool good = tool_m.allFinite() && std::isfinite(step_s) && contacts <= kMostLocalContacts;
        for (std::size_t i = 0; good && i < contacts; ++i) {
            const LocalContact& c = contact[i];
            good = c.position_m.allFinite() && c.normal.allFinite() && std::isfinite(c.gap_m) && c.force_n.allFinite() && c.velocity_m_s.allFinite();
        }
        for (std::size_t i = 0; good && i < 9 * contacts * contacts; ++i) good = std::isfinite(compliance[i]);
        return good;
    }
    /// What matters, without the unused places.
    void copy_from(const LocalModel& other) noexcept {
        number = other.number;
        step_s = other.step_s;
        tool_m = other.tool_m;
        contacts = other.contacts;
        std::copy_n(other.contact.begin(), contacts, contact.begin());
        std::copy_n(other.compliance.begin(), 9 * contacts * contacts, compliance.begin());
    }
};

}  // namespace supple::haptics
