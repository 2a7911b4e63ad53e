#include <algorithm>

#include "demo.h"

namespace supple::demos {
namespace {

// Inside a function, so that it exists before the first demo of any file registers itself.
std::vector<Demo>& registry() {
    static std::vector<Demo> demos;
    return demos;
}

}  // namespace

RegisterDemo::RegisterDemo(Demo demo) {
    auto& demos = registry();
    const auto place = std::lower_bound(demos.begin(), demos.end(), demo, [](const Demo& a, const Demo& b) { return a.name < b.name; });
    demos.insert(place, std::move(demo));
}

const std::vector<Demo>& all_demos() { return registry(); }

}  // namespace supple::demos
