#pragma once
#include "view/desk.h"

namespace supple::demos::view {

/// The mouse over the picture: it uses the tool where it meets a body, and turns, moves and zooms the camera otherwise.
class Hand {
public:
    void act(Desk& desk);  ///< once a frame, after the panels

private:
    enum class At { nothing, tool, turn, shift } at_ = At::nothing;
    int button_ = 0;

    void begin(Desk& desk, const Pointer& pointer);
};

}  // namespace supple::demos::view
