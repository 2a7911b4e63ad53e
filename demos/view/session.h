#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hud.h"
#include "open_show.h"

namespace supple::demos::view {

/// A flag that was raised lately.
struct FlagNote {
    StepFlag flag = StepFlag::none;
    std::size_t steps = 0;     ///< that raised it since the scene was opened
    std::size_t quiet = 0;     ///< steps since it was last raised
    static constexpr std::size_t kLately = 120;  ///< less quiet than this: it is still going on
};

/// What all the steps of one frame did together.
struct FrameSteps {
    int steps = 0;
    double step_ms = 0;
    std::array<double, kStageCount> stage_ms{};
    int iterations = 0;        ///< mean per step
    double dropped_s = 0;      ///< real time that could not be kept up with
};

/// The show that is open, its clock, and what a person changed in it; restart() keeps those changes.
class Session {
public:
    explicit Session(ShowOptions options) : options_(options) {}

    /// A demo by its name, a scene file or a mesh file. Where it cannot be opened, what was open stays.
    /// @error as open_show(), io::read_scene() and open_mesh()
    void open(const std::string& scene);
    void restart();  ///< from the beginning, with the materials and the solver of the moment

    bool is_open() const { return opened_.show != nullptr; }
    Show& show() { return *opened_.show; }
    World& world() { return opened_.show->world(); }
    const std::string& name() const { return opened_.name; }
    const std::string& source() const { return source_; }
    std::size_t openings() const { return openings_; }  ///< a larger number: another World, ids of the old one are void

    // -- time
    bool playing = true;
    double time_scale = 1;
    /// As many fixed steps as `real_s` asks for, like World::advance(); but the show acts between them.
    FrameSteps advance(double real_s);
    FrameSteps step_once();
    double alpha() const { return alpha_; }  ///< where between the last two states the picture is
    bool script_plays() const { return script_; }
    void take_over();                        ///< ends the scripted touch: a hand comes
    /// Called before each step, after the show's own.
    void set_before_step(std::function<void(double step_s)> act) { before_step_ = std::move(act); }

    // -- changes
    void set_material(std::size_t body, const Material& material);
    void set_stiffness_factor(std::size_t body, double factor);  ///< on top of the definition's own factors
    double stiffness_factor(std::size_t body) const { return body < edits_.size() ? edits_[body].factor : 1; }
    void set_solver(const SolverDef& solver);
    void set_gravity(const Vec3& gravity_m_s2);
    const Vec3& down() const { return down_; }  ///< where gravity pointed when the scene was opened; -y in free space

    const std::vector<FlagNote>& flags() const { return flags_; }
    const StepReport& last() const { return last_; }
    std::string hud_text() const { return hud_->text(); }

private:
    struct Edit {
        std::optional<Material> material;
        double factor = 1;
        std::vector<double> own_factors;  ///< of the definition, before ours
        double applied = 1;               ///< of ours, in the definition as it is
    };

    OpenedShow open_any(const std::string& scene) const;
    void begin(OpenedShow opened);
    void apply(std::size_t body);
    void grow_to(std::size_t body);  ///< bodies may have come since the scene was opened: pieces that were cut off
    void step(FrameSteps& frame);
    void note_flags();

    ShowOptions options_;
    OpenedShow opened_;
    std::string source_;
    std::size_t openings_ = 0;
    double pending_s_ = 0, alpha_ = 1;
    bool script_ = true;
    std::function<void(double)> before_step_;
    std::vector<Edit> edits_;
    std::optional<SolverDef> solver_;
    std::optional<Vec3> gravity_m_s2_;
    Vec3 down_ = Vec3(0, -1, 0);
    std::vector<FlagNote> flags_;
    StepReport last_;
    std::optional<Hud> hud_;
};

}  // namespace supple::demos::view
