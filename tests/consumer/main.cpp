#include <supple/supple.h>

#include <cstdio>

int main() {
    supple::World world;
    const auto bar = supple::BodyTemplate::build(supple::make_tet_box({.max_m = {0.4, 0.1, 0.1}, .cells = {8, 2, 2}}));
    const supple::BodyId body = world.add_body({.shape = bar});
    world.fix(body, supple::InsideBox{{0, 0, 0}, {1e-6, 1, 1}});
    for (int i = 0; i < 20; ++i) world.step();
    std::printf("tip %g m\n", world.positions(body).back().y());
    return world.positions(body).back().y() < 0.1 ? 0 : 1;
}
