#pragma once
#include <map>
#include <vector>

#include "supple/haptics/local_model.h"
#include "supple/world/response.h"

namespace supple::haptics {

inline constexpr std::size_t kMostHeld = 8;

struct ModelBuilderDef {
    std::size_t patch_vertices = 120;  ///< of a body, condensed by a dense factor, [8, 400]; its cost grows with the third power
    double reach_m = 0;                ///< gaps up to this are watched; 0: half an edge of the body, and what 0.5 m/s go in a step
    int correct_every = 4;             ///< steps between solves of the full system, [0, 1000]; 0: the rim of the patch stays clamped
    double correction_tolerance = 1e-3;///< of these, (0, 0.5]
};

/// A vertex that the tool has taken hold of.
struct HeldPoint {
    AttachmentId attachment;
    BodyId body;
    std::int32_t vertex = -1;
};

/// What a model cost and what it holds.
struct ModelReport {
    double total_us = 0, find_us = 0, patch_us = 0, correction_us = 0;
    std::size_t contacts = 0;          ///< of the model
    std::size_t merged = 0;            ///< contacts of the simulation that share a place of the model with others, their forces added
    std::size_t left_out = 0;          ///< near points for which there was no place: the farthest
    std::size_t patch_vertices = 0;    ///< of all bodies
    int correction_iterations = 0;
    double far_field = 0;              ///< part of the compliance that lies beyond the patch: trace of the correction over that of the whole
    bool indefinite = false;           ///< a patch had no Cholesky factor: its contacts answer by their own vertices alone
};

/// Makes local models of what is around a collider, after World::step(), on the simulation's thread.
///
/// Compliance of the contacts from the body's system of the last step, condensed onto a patch: with the vertices beyond held, W = h^2 J A_pp^-1 J^T. What the rim
/// hides is nearly the same for all contacts, a shift of the whole patch: every few steps the full system is solved for a unit force on the touched place in
/// each direction, and the 3 x 3 difference is added to every block of W.
class ModelBuilder {
public:
    /// @error Error(invalid_argument) naming the field
    explicit ModelBuilder(const ModelBuilderDef& def = {});
    /// Fills `model` but for its number.
    /// @param held  attachments to the tool: they come first, at most kMostHeld
    const ModelReport& build(const World& world, ColliderId tool, LocalModel& model, std::span<const HeldPoint> held = {});
    const ModelReport& report() const { return report_; }

private:
    struct Row {
        std::int32_t vertex;
        double weight;
    };
    struct Candidate {
        BodyId body;
        LocalContact contact;
        std::vector<Row> rows;
        double press_n = 0;  ///< along the normal
        double edge_m = 0;
    };
    struct Memory {
        Mat3 far_field = Mat3::Zero();
        std::array<std::vector<Vec3>, 3> displacement;
        int steps_left = 0;
    };

    void find_held(const World& world, std::span<const HeldPoint> held);
    void find_pressed(const World& world, ColliderId tool);
    void find_near(const World& world, ColliderId tool);
    void merge(std::size_t from, std::size_t most);
    void fill_body(const World& world, ColliderId tool, BodyId body, LocalModel& model);
    void correct(const BodyResponse& response, Memory& memory, std::span<const std::size_t> places, const LocalModel& model);

    ModelBuilderDef def_;
    ModelReport report_;
    std::vector<Candidate> found_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, Memory> memory_;  ///< by body
    MatX A_, B_;
};

}  // namespace supple::haptics
