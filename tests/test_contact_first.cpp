#include <gtest/gtest.h>
#include "support/bodies.h"
namespace supple { namespace {
TEST(ContactFirst, CubeOnPlane) {
    for (auto precision : {Precision::single, Precision::double_}) {
    WorldDef def; def.threads=1; def.solver.precision = precision;
    World world(def);
    const BodyId body = world.add_body({.shape = test::cube(4, 0.1), .material = Corotational{.young_pa = 2e4, .poisson = 0.4}, .translation_m={0,0.02,0}});
    world.add_collider({.shape = PlaneShape{}, .friction = std::getenv("MU") ? atof(std::getenv("MU")) : 0.3});
    for (int n = 0; n < 60; ++n) {
        const StepReport r = world.step();
        double low=1e9; for (auto& x: world.positions(body)) low=std::min(low,x.y());
        if (n>6 && n<40) printf("%3d flags %u its %d contacts %d ci %d low %.3e F %.6f v %.2e\n", n, unsigned(r.flags), r.cg_iterations, r.contacts, r.contact_iterations, low, world.contact_force_n().y(), world.velocities(body)[0].norm());
    }
    double m=0; for (double x: world.masses(body)) m+=x;
    printf("weight %.9f contact %.9f\n", m*9.81, world.contact_force_n().y());
    }
}
}}
