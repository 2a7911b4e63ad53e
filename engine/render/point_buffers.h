#pragma once
#include <vector>

#include "supple/base/function_ref.h"
#include "supple/render/gl_objects.h"
#include "supple/render/scene_frame.h"

namespace supple::render {

/// The points of one frame on their way to the graphics card.
class PointBuffers {
public:
    /// @error Error(invalid_argument) naming FrameView.points[i] and the field
    void prepare(const std::vector<PointsView>& views, const SceneFrame& frame);
    void upload();
    void draw(FunctionRef<void(float size_px)> set_size) const;
    int reach_px() const;  ///< how far the largest point reaches from its centre
    bool empty() const { return positions_.empty(); }
    const std::vector<Eigen::Vector3f>& positions() const { return positions_; }

private:
    struct Range {
        std::size_t begin, count;
        float size_px;
    };
    std::vector<Eigen::Vector3f> positions_;
    std::vector<float> values_;
    std::vector<Range> ranges_;
    VertexArray array_;
    Buffer position_buffer_, value_buffer_;
};

}  // namespace supple::render
