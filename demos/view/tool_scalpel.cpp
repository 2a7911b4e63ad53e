#include <imgui.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "drawn_shapes.h"
#include "view/gui.h"
#include "view/tools.h"

namespace supple::demos::view {
namespace {

constexpr double kSpacing = 0.012;  // of the scene's size: between the points of the blade's way
constexpr int kMostParts = 100;     // that a movement between two frames is divided into
constexpr std::size_t kLooks = 8;   // points of the way whose surface is found anew in a frame
constexpr double kBefore = 0.04;    // of the scene's size: the blade begins so far before the surface

/// A movement over the picture, and under it a blade that reaches from before the surface into the depth. It cuts when the button is let go.
class Scalpel : public Tool {
public:
    const char* name() const override { return "Scalpel"; }
    const char* hint() const override { return "Draw a line over a body with the left button; let go: it is cut along it. Begin and end beside the body to cut it through; the wheel sets the depth."; }
    bool begins_beside() const override { return true; }
    bool edits() const override { return true; }

    bool press(World& world, const Pointer& pointer, const ToolScale& scale) override {
        scale_ = scale;
        holds_ = true;
        way_.clear();
        add(world, pointer.ray);
        return true;
    }

    void move(World& world, const Pointer& pointer) override {
        if (!holds_) return;
        for (std::size_t i = 0; i < kLooks; ++i) look(world, way_[looked_++ % way_.size()]);  // bodies move on under the blade
        // A fast hand leaves gaps: they are filled, for the surface between two points may come nearer than both.
        const Ray last = way_.back().ray;
        const double gap_m = (pointer.ray.origin - last.origin + reach_m_ * (pointer.ray.direction - last.direction)).norm();
        const int parts = std::min(kMostParts, int(gap_m / (kSpacing * scale_.size_m)));
        for (int k = 1; k <= parts; ++k) {
            const double s = double(k) / parts;
            add(world, {last.origin + s * (pointer.ray.origin - last.origin), (last.direction + s * (pointer.ray.direction - last.direction)).normalized()});
        }
    }

    void scroll(World&, double steps) override { depth_ = std::clamp(depth_ + 0.02 * steps, 0.02, 1.5); }

    void release(World& world) override {
        if (!holds_) return;
        holds_ = false;
        std::vector<BodyId> bodies;
        for (Sample& sample : way_) {
            const BodyId body = look(world, sample);
            if (body && std::find(bodies.begin(), bodies.end(), body) == bodies.end()) bodies.push_back(body);
        }
        const std::vector<Vec3> from = edge(-kBefore * scale_.size_m), to = edge(depth_ * scale_.size_m);
        if (from.size() < 2) return;
        const mesh::TriangleMesh blade = swept_blade(from, to);
        for (const BodyId body : bodies) cut(world, body, blade);
    }
    /// Pieces that became bodies go, their matter comes back: where the body, and they, are as the cut left them.
    bool undo(World& world) override {
        const std::vector<BodyId> living = world.bodies();
        const auto lives = [&](BodyId id) { return std::find(living.begin(), living.end(), id) != living.end(); };
        for (auto cut = cuts_.rbegin(); cut != cuts_.rend(); ++cut) {
            if (!lives(cut->body) || world.element_ids(cut->body) != cut->elements) continue;
            for (const BodyId piece : cut->pieces)
                if (lives(piece)) world.remove_body(piece);
            for (int i = 0; i < cut->edits; ++i) world.undo_edit(cut->body);
            cuts_.erase(std::next(cut).base());
            return true;
        }
        return false;
    }
    void forget() override { cuts_.clear(); }
    void cancel(World&) override { holds_ = false; }
    bool holds() const override { return holds_; }
    double force_n(const World&) const override { return 0; }

    void draw(const World&, FrameView& view) const override {
        drawn_.clear();
        if (!holds_ || way_.size() < 2) return;
        const std::vector<Vec3> before = edge(-kBefore * scale_.size_m), on = edge(0), to = edge(depth_ * scale_.size_m);
        const double edge_m = 0.003 * scale_.size_m;
        drawn_.surface(thick_strip(before, to, 0.002 * scale_.size_m), {0.75f, 0.85f, 0.95f}, Look::metal, 0.55);
        drawn_.tube(on, std::array{edge_m}, {1.0f, 0.85f, 0.2f});
        drawn_.add_to(view);
    }

    void panel(double) override {
        percent_slider("Depth", "blade depth", depth_, 0.02, 1.5, "of the blade under the surface, as a part of the scene's size; the wheel while drawing, too");
        checkbox("Pieces become bodies", "part pieces", part_, "What is cut off and held by nothing becomes a body of its own; a body that nothing holds keeps its largest piece");
        percent_slider("Smallest piece", "smallest piece", crumb_, 0, 0.1, "of the volume of its body: smaller pieces that a cut leaves are taken away; never the largest");
    }

private:
    struct Sample {
        Ray ray;
        std::optional<double> surface_m;  ///< along it; none beside the bodies
    };

    /// A cut that made bodies.
    struct Parted {
        BodyId body;
        std::vector<BodyId> pieces;
        std::vector<std::uint32_t> elements;  ///< ids of the body's after it
        int edits = 0;
    };

    void cut(World& world, BodyId body, const mesh::TriangleMesh& blade) {
        Parted parted{body, {}, {}, 0};
        parted.edits += !world.cut(body, blade).is_identity();
        const std::vector<Piece> pieces = world.pieces(body);
        if (parted.edits == 0 || pieces.size() < 2) return;
        double volume = 0;
        for (const Piece& piece : pieces) volume += piece.volume_m3;
        parted.edits += !world.remove_pieces(body, crumb_ * volume).is_identity();
        if (part_) parted.pieces = world.split_off_pieces(body);
        parted.edits += !parted.pieces.empty();
        if (parted.edits == 1) return;
        parted.elements = world.element_ids(body);
        cuts_.push_back(std::move(parted));
    }

    void add(World& world, const Ray& ray) {
        Sample sample{ray, {}};
        look(world, sample);
        if (sample.surface_m) reach_m_ = *sample.surface_m;
        else if (way_.empty()) reach_m_ = 2 * scale_.size_m;
        way_.push_back(sample);
    }

    /// Where the surface under a sample is now; the body that it is of.
    static BodyId look(const World& world, Sample& sample) {
        const auto hit = world.pick(sample.ray);
        sample.surface_m.reset();
        if (!hit) return {};
        sample.surface_m = (hit->position_m - sample.ray.origin).norm();
        return hit->body;
    }

    /// The way of the blade, `behind_m` behind the surface. Beside the bodies it goes on as deep as where it was nearest over one.
    std::vector<Vec3> edge(double behind_m) const {
        std::vector<Vec3> points;
        for (std::size_t i = 0; i < way_.size(); ++i) {
            std::optional<double> surface = way_[i].surface_m;
            for (std::size_t k = 1; !surface && k < way_.size(); ++k) {
                if (i >= k) surface = way_[i - k].surface_m;
                if (!surface && i + k < way_.size()) surface = way_[i + k].surface_m;
            }
            points.push_back(way_[i].ray.origin + (surface.value_or(reach_m_) + behind_m) * way_[i].ray.direction);
        }
        // A hand shakes: the mean with the neighbours.
        std::vector<Vec3> smooth = points;
        for (std::size_t i = 1; i + 1 < points.size(); ++i) smooth[i] = 0.25 * points[i - 1] + 0.5 * points[i] + 0.25 * points[i + 1];
        return smooth;
    }

    std::vector<Sample> way_;
    std::size_t looked_ = 0;
    ToolScale scale_;
    bool holds_ = false;
    double reach_m_ = 1;          ///< to the last point of a surface
    double depth_ = 0.3;
    bool part_ = true;
    std::vector<Parted> cuts_;
    double crumb_ = 0;
    mutable DrawnShapes drawn_;   ///< views borrow from it
};

}  // namespace

std::unique_ptr<Tool> make_scalpel_tool() { return std::make_unique<Scalpel>(); }

}  // namespace supple::demos::view
