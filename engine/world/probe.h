#pragma once
#include <limits>
#include <string>
#include <vector>

#include "supple/mesh/selection.h"
#include "supple/world/world.h"

namespace supple {

/// What to watch in a part of a body.
struct ProbeDef {
    std::string name{};             ///< for tables; "probe" if empty
    Selection where{};              ///< a region's name takes its elements
    StrainMeasure strain = StrainMeasure::corotational;
    double threshold_pa = std::numeric_limits<double>::infinity();  ///< of von Mises, > 0
    double threshold_m = std::numeric_limits<double>::infinity();   ///< of displacement, > 0
};

/// One reading.
struct ProbeSample {
    double time_s = 0;
    double peak_von_mises_pa = 0;      ///< largest in the part
    double mean_von_mises_pa = 0;      ///< weighted by rest volume
    std::int32_t peak_at = -1;         ///< element (or vertex, Probe::on_elements) of the peak
    double over_threshold_s = 0;       ///< time so far with the peak above threshold_pa
    double peak_displacement_m = 0;    ///< from the start positions of the body
    double mean_displacement_m = 0;    ///< weighted by rest volume
    double displaced_s = 0;            ///< time so far with the peak displacement above threshold_m
};

/// Watches a part of a body: peak, mean and time over a threshold of stress and displacement. Stress is that of the elements that
/// the selection holds whole; where it holds none (a patch of surface), that of its vertices, recovered by volume.
class Probe {
public:
    /// @error Error(invalid_argument) if the selection is empty or a threshold is not above zero
    Probe(const World& world, BodyId body, const ProbeDef& def);

    /// Reads the world as it stands; call it after each step (or every n steps: the time since the last reading counts as one stretch).
    /// After an edit of the body's mesh the selection is made again on the mesh as it is, a vertex list of those of its vertices that are left; a part that is gone
    /// reads zero. A world that has gone back in time (reset, restore) starts the times over a threshold anew.
    const ProbeSample& read(const World& world);

    const ProbeSample& sample() const { return sample_; }
    const ProbeDef& def() const { return def_; }
    BodyId body() const { return body_; }
    bool on_elements() const { return on_elements_; }

private:
    void select(const World& world);
    ProbeDef def_;
    BodyId body_;
    bool on_elements_ = true;
    std::vector<std::int32_t> stressed_, vertices_;     ///< elements or vertices; vertices
    std::vector<double> stress_weight_, vertex_weight_; ///< rest volumes, each list sums to one
    std::vector<Vec3> start_;
    std::uint64_t edits_ = 0;                           ///< World::edit_count() of the selection
    std::vector<std::uint32_t> listed_;                 ///< ids of a vertex list
    ProbeSample sample_;
    StressField field_;
};

}  // namespace supple
