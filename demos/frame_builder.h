#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "collider_view.h"
#include "demo.h"
#include "supple/render/frame_view.h"

namespace supple::demos {

struct FrameOptions {
    std::optional<ColorBy> color_by;  ///< none: what the show wants
    enum class At { vertex, element, point };
    At stress_at = At::vertex; ///< smooth; flat per element; points at the centres of the elements in a translucent body
    std::optional<std::array<double, 2>> range_pa;  ///< of the colours; empty: the show's, or automatic
    bool automatic_range = false;                   ///< also where the show sets one
    std::optional<double> opacity;                  ///< of the bodies; empty: 1, for points 0.25
    bool wireframe = false;
    bool contacts = false;     ///< arrows for the forces of contacts
    std::string map = "viridis";
};

/// The upper end of the colour scale: the stress that 99 % of the vertices stay below, rounded up to 1, 2 or 5 times a power of ten,
/// raised at once and lowered only when it has been far too high for a while. So the legend does not flicker.
class StressRange {
public:
    double update(std::vector<double> stresses_pa, double elapsed_s);

private:
    double high_pa_ = 0;
    double too_high_s_ = 0;
};

/// Makes the picture of a show at a moment between its last two steps. The view borrows from the builder and the world.
class FrameBuilder {
public:
    FrameBuilder(Show& show, FrameOptions options);

    /// @param alpha        0 = before the last step, 1 = after it
    /// @param hud          the line at the top left
    /// @param elapsed_s    simulated time since the last picture
    FrameView& build(double alpha, const std::string& hud, double elapsed_s);

    FrameOptions& options() { return options_; }  ///< for the next picture

private:
    Show* show_;
    FrameOptions options_;
    double ground_m_, size_m_;
    Vec3 centre_;
    ColliderView colliders_;
    StressRange range_;
    FrameView view_;
    std::vector<std::vector<Vec3>> positions_, centres_, skin_;
    struct Inner {
        std::uint64_t edits = 0;
        const void* skin = nullptr;
        std::vector<char> of_triangle;
    };
    std::map<std::uint64_t, Inner> inner_;  ///< by body
    std::vector<std::vector<double>> flat_, stiffness_, on_skin_;  ///< per body: of triangles, of vertices, of skin vertices

    void add_stress(std::size_t b, const Skin* skin, SurfaceView& surface, std::vector<double>& stresses);
    std::span<const char> inner_of(BodyId body, const Skin* skin);
    SurfaceView make_surface(std::size_t b, const Skin* skin);
    /// A number per vertex of the mesh on the surface that is drawn.
    std::span<const double> on_surface(std::size_t b, const Skin* skin, std::span<const double> per_vertex);
};

}  // namespace supple::demos
