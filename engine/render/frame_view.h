#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple {

/// How a surface looks where no scalar is mapped.
enum class Look { tissue, rubber, gel, metal };

/// One triangle surface of a frame. Spans are borrowed until draw() returns.
struct SurfaceView {
    std::span<const Vec3> positions;                     ///< per vertex [m], finite; vertices of no triangle are skipped
    std::span<const Triangle> triangles;                 ///< outward counter-clockwise; a closed surface shows its outside only
    std::span<const double> scalar;                      ///< per vertex, e.g. von Mises [Pa]; empty = plain material; NaN is drawn grey
    std::span<const double> triangle_scalar;             ///< per triangle, drawn flat; instead of `scalar`
    double opacity = 1;                                  ///< (0, 1]; below 1 what lies behind the nearest layer of the surface shines through
    std::span<const std::array<std::int32_t, 2>> edges;  ///< wireframe lines; empty = none
    std::span<const Vec3> rest_positions;                ///< drawn as a faint outline (contour and crisp edges); empty = none
    Look look = Look::tissue;
    double crease_angle_deg = 40;  ///< 0..180; normals are smooth across edges below it, crisp above

    /// Rest shape, per vertex, not drawn: fixes the grain of the tissue to the material and says which edges are crisp. Empty: no grain,
    /// and the creases are those of the first positions that came with these triangles (they do not flicker while the body bends).
    std::span<const Vec3> reference_positions;
    std::optional<std::array<float, 3>> color;  ///< sRGB 0..1, instead of the look's own colour

    std::span<const char> inner;                      ///< per triangle, 1: laid open by a cut, drawn in `inner_color` with a crisp edge around; empty = none
    std::optional<std::array<float, 3>> inner_color;  ///< sRGB 0..1; empty: of tissue that of raw flesh, of other looks the same as outside, brighter
};

/// Points coloured by a number: values where they are computed, inside a body too (give its surface an opacity below 1).
struct PointsView {
    std::span<const Vec3> positions;  ///< [m], finite
    std::span<const double> scalar;   ///< one per position; NaN is drawn grey
    double size_px = 7;               ///< diameter, 1..64
};

struct ArrowView {                                  ///< a force
    Vec3 from_m, to_m;                              ///< an arrow of no length is not drawn
    std::array<float, 3> color{1.0f, 0.85f, 0.2f};  ///< sRGB 0..1
};

struct MarkerView {  ///< a tool or a picking cursor
    Vec3 centre_m;
    double radius_m;
    std::array<float, 3> color{0.95f, 0.95f, 1.0f};  ///< sRGB 0..1
};

struct LabelView {  ///< a short name beside a thing, centred on the projection of a point; hidden behind the camera
    Vec3 at_m;
    std::string text;  ///< UTF-8, one line
};

struct ColorScale {
    std::string map = "viridis";  ///< any of color_map_names()
    double low = 0, high = 1;     ///< low < high; values outside take the end colours
    std::string title = "von Mises";
    std::string unit = "Pa";  ///< prefixes k, M, G are chosen by the legend
};

struct Camera {
    Vec3 eye_m = Vec3(0.2, 0.1, 0.8);
    Vec3 target_m = Vec3::Zero();
    Vec3 up = Vec3(0, 1, 0);
    double fov_deg = 40;  ///< vertical, 1..170
};

/// A number over time, drawn into the upper right corner: a force on a hand.
struct PlotView {
    std::string title;                              ///< UTF-8, one line; its unit belongs in it
    double begin = 0, end = 1, low = 0, high = 1;   ///< of the axes, begin < end and low < high; a round `high` is written beside its line
    struct Curve {
        std::vector<std::array<double, 2>> points;  ///< ascending in the first number; what lies outside of the axes is cut off
        std::array<float, 3> color{1.0f, 0.85f, 0.2f};  ///< sRGB 0..1
        std::string name;                           ///< written beside the title in its colour; empty = none
    };
    std::vector<Curve> curves;
};

/// Everything that one picture shows. The renderer reads nothing else: no World, no file.
struct FrameView {
    std::vector<SurfaceView> surfaces;
    std::vector<PointsView> points;
    std::vector<ArrowView> arrows;
    std::vector<MarkerView> markers;
    std::vector<LabelView> labels;
    std::optional<PlotView> plot;
    std::optional<ColorScale> scale;        ///< needed if a surface or points have a scalar; its legend is drawn then
    std::optional<double> ground_height_m;  ///< along `camera.up`; catches the shadow
    Camera camera;
    std::optional<Vec3> key_light;  ///< direction towards the key light; empty = over the left shoulder of the camera.
                                    ///< Set it where the camera moves, so that the shadows do not.
    std::string caption;            ///< large, lower left, UTF-8, wrapped; empty = none
    std::string hud;                ///< one small line, top left; empty = none
};

}  // namespace supple
