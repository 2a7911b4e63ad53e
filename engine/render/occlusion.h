#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace supple::render {

/// Ambient occlusion from a coarse picture of where matter is: the area of all triangles is dropped into a grid of about 32 cells along the
/// longest side, and a point looks for it along its normal at three distances, through ever coarser grids. Costs about a millisecond for
/// 20,000 triangles, does not depend on the view and therefore does not flicker, and needs nothing of the graphics card.
class OcclusionGrid {
public:
    /// @param low, high  bounds of everything that will be added, y up
    void reset(const Eigen::Vector3f& low, const Eigen::Vector3f& high);
    void add(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c);
    void finish();  ///< builds the coarser grids; call it after the last add()

    /// 0 dark .. 1 open, at a point of a surface with that unit normal.
    float openness(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;

    /// Light from above that reaches the plane y = height: kGroundSize^2 values, rows along z, over [ground_low, ground_high] in x and z.
    static constexpr int kGroundSize = 64;
    void ground(float height, std::vector<std::uint8_t>& openness);
    Eigen::Vector2f ground_low() const { return ground_low_; }
    Eigen::Vector2f ground_high() const { return ground_high_; }

private:
    struct Level {
        Eigen::Array3i size{0, 0, 0};
        float cell = 1;
        std::vector<float> opacity;  // matter of a cell: area / cell^2
        float& at(int x, int y, int z) { return opacity[std::size_t((z * size.y() + y) * size.x() + x)]; }
        float sample(const Eigen::Vector3f& p) const;  // p in cells of this level
    };
    void drop(const Eigen::Vector3f& point, float area);

    Eigen::Vector3f origin_{0, 0, 0};
    std::array<Level, 3> levels_;
    Eigen::Vector2f ground_low_{0, 0}, ground_high_{1, 1};
    std::vector<float> light_, blurred_;
};

}  // namespace supple::render
