#pragma once
#include <string>
#include <vector>

#include "supple/mesh/surface.h"
#include "supple/render/frame_view.h"
#include "supple/world/world.h"

namespace supple::demos {

/// One touch of a scripted tool: it comes along a ray, holds the patch of surface it meets, moves it, and lets go.
struct Touch {
    double begin_s = 0;                ///< when it touches; it is seen coming for the second before
    double end_s = 1;                  ///< when it lets go
    Ray ray;                           ///< the tool comes along it; a miss is an Error of the demo
    double radius_m = 0.01;            ///< of the patch
    double tool_radius_m = 0.01;       ///< of the ball that stands for the tool
    Timeline<Vec3> displacement_m;     ///< of the tool from where it touched; times from begin_s
    double stiffness_n_m = 0;          ///< 0 = from the local effective mass
    double max_force_n = 0;            ///< 0 = no cap
    bool pushes = true;                ///< the tool is drawn outside and its arrow ends at the patch; a pull's arrow begins there
    std::string caption;
};

/// Plays touches, one at a time, and shows them: tool, force arrow, caption, force in the HUD.
class TouchScript {
public:
    /// @param arrow_m  length that the arrow of an endless force would have; that of `usual_n` newtons has 63 % of it. So small forces are
    ///                 seen and large ones stay in the picture; the number stands in the HUD.
    TouchScript(World& world, std::vector<Touch> touches, double arrow_m, double usual_n);

    void before_step();                 ///< begins, moves and ends drags as the world's time asks for
    void let_go();                      ///< ends the touch at work and plays no more
    void decorate(FrameView& view) const;

private:
    const Touch* coming() const;        ///< the next touch, if it is less than a second away

    World* world_;
    std::vector<Touch> touches_;
    double arrow_m_, usual_n_;
    std::size_t next_ = 0;              ///< first touch that has not ended
    DragId drag_;
    Vec3 start_m_ = Vec3::Zero();       ///< where the current touch met the surface
};

/// Where a tool is between two moments, starting and stopping gently: 0 before, 1 after.
double smooth_step(double from, double to, double time);

/// Adds "   force 3.20 N" to the HUD line.
void show_force(FrameView& view, const Vec3& force_n);

}  // namespace supple::demos
