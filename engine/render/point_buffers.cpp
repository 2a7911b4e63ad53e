#include "supple/render/point_buffers.h"

#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/render/surface_buffers.h"

namespace supple::render {

void PointBuffers::prepare(const std::vector<PointsView>& views, const SceneFrame& frame) {
    positions_.clear();
    values_.clear();
    ranges_.clear();
    for (std::size_t i = 0; i < views.size(); ++i) {
        const PointsView& view = views[i];
        const std::string name = "FrameView.points[" + std::to_string(i) + "]";
        if (view.scalar.size() != view.positions.size())
            throw Error(ErrorCode::invalid_argument, name + ".scalar",
                        "has " + std::to_string(view.scalar.size()) + " values for " + std::to_string(view.positions.size()) + " positions; give one each");
        require_in_range(view.size_px, 1, 64, name + ".size_px", "7 is usual");
        ranges_.push_back({positions_.size(), view.positions.size(), float(view.size_px)});
        for (std::size_t k = 0; k < view.positions.size(); ++k) {
            positions_.push_back(frame.point(view.positions[k]));
            if (!positions_.back().allFinite())
                throw Error(ErrorCode::invalid_argument, name + ".positions", "point " + std::to_string(k) + " is not finite, or too far away to draw");
            values_.push_back(shader_value(view.scalar[k]));
        }
    }
}

void PointBuffers::upload() {
    if (empty()) return;
    glBindVertexArray(array_.get());
    upload_buffer(GL_ARRAY_BUFFER, position_buffer_, std::span<const Eigen::Vector3f>(positions_), GL_STREAM_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    upload_buffer(GL_ARRAY_BUFFER, value_buffer_, std::span<const float>(values_), GL_STREAM_DRAW);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(1, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
    glBindVertexArray(0);
}

int PointBuffers::reach_px() const {
    float largest = 0;
    for (const Range& r : ranges_) largest = std::max(largest, r.size_px);
    return int(std::ceil(largest / 2));
}

void PointBuffers::draw(FunctionRef<void(float size_px)> set_size) const {
    glBindVertexArray(array_.get());
    for (const Range& r : ranges_) {
        set_size(r.size_px);
        glDrawArrays(GL_POINTS, GLint(r.begin), GLsizei(r.count));
    }
}

}  // namespace supple::render
