#pragma once
#include <string>
#include <vector>

#include "supple/world/world.h"

namespace supple::demos {

/// The line at the top left of a picture: medians of the last steps, so that the digits can be read.
class Hud {
public:
    explicit Hud(const World& world);  ///< which must outlive it
    void add(const StepReport& report);
    std::string text() const;

private:
    const World* world_;
    int threads_;
    std::vector<double> last_ms_, last_iterations_;
};

}  // namespace supple::demos
