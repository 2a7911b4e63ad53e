#include "bullet_peer.h"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

namespace supple::peers {
namespace {

/// Bullet keeps the number of its iterations to itself; each asks the elasticity once for K dx.
class CountedElasticity final : public btDeformableLinearElasticityForce {
public:
    using btDeformableLinearElasticityForce::btDeformableLinearElasticityForce;
    void addScaledElasticForceDifferential(btScalar scale, const TVStack& dv, TVStack& df) override {
        ++products;
        btDeformableLinearElasticityForce::addScaledElasticForceDifferential(scale, dv, df);
    }
    int products = 0;
};

/// The limits of its conjugate gradients are not public.
class TolerantSolver final : public btDeformableBodySolver {
public:
    TolerantSolver(double tolerance, int most_iterations) {
        m_cg.m_maxIterations = most_iterations;
        m_cg.setTolerance(btScalar(tolerance * tolerance));  // it compares squares: r.M^-1 r with that of the right-hand side
    }
};

btVector3 bt(const Vec3& v) { return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())}; }

class Bullet final : public Peer {
public:
    explicit Bullet(const Problem& p)
        : dispatcher_(&configuration_),
          solver_(p.tolerance, p.most_iterations),
          world_(&dispatcher_, &broadphase_, &constraints_, &configuration_, &solver_),
          time_step_(btScalar(p.time_step_s)) {
        constraints_.setDeformableSolver(&solver_);
        const btVector3 gravity(0, btScalar(-p.gravity_m_s2), 0);
        world_.setGravity(gravity);
        world_.getWorldInfo().m_gravity = gravity;
        world_.setImplicit(true);
        world_.setLineSearch(false);
        world_.setUseProjection(true);

        std::vector<btVector3> x;
        std::vector<btScalar> mass;
        const std::vector<double> kg = p.vertex_mass_kg();
        for (std::size_t v = 0; v < p.mesh.vertices.size(); ++v) {
            x.push_back(bt(p.mesh.vertices[v]));
            mass.push_back(p.is_held(v) ? btScalar(0) : btScalar(kg[v]));
        }
        body_ = new btSoftBody(&world_.getWorldInfo(), int(x.size()), x.data(), mass.data());  // the world does not own it
        for (const Tet& t : p.mesh.tets) body_->appendTetra(t[0], t[1], t[2], t[3]);
        body_->initializeDmInverse();
        body_->m_tetraScratches.resize(body_->m_tetras.size());
        body_->m_tetraScratchesTn.resize(body_->m_tetras.size());
        body_->m_cfg.collisions = 0;
        body_->setSelfCollision(false);
        body_->setActivationState(DISABLE_DEACTIVATION);
        world_.addSoftBody(body_);
        elasticity_.setYoungsModulus(btScalar(p.young_pa));
        elasticity_.setPoissonRatio(btScalar(p.poisson));
        elasticity_.setDamping(0, 0);
        gravity_ = std::make_unique<btDeformableGravityForce>(gravity);
        world_.addForce(body_, &elasticity_);
        world_.addForce(body_, gravity_.get());
    }
    ~Bullet() override {
        world_.removeSoftBody(body_);
        delete body_;
    }

    std::string name() const override { return "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." + std::to_string(BT_BULLET_VERSION % 100) + " float"; }
    int step() override {
        elasticity_.products = 0;
        world_.stepSimulation(time_step_, 1, time_step_);
        return elasticity_.products - 1;  // one for the first residual
    }
    Vec3 position(std::size_t v) const override {
        const btVector3& x = body_->m_nodes[int(v)].m_x;
        return {double(x.x()), double(x.y()), double(x.z())};
    }

private:
    btSoftBodyRigidBodyCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btDeformableMultiBodyConstraintSolver constraints_;
    TolerantSolver solver_;
    CountedElasticity elasticity_;
    std::unique_ptr<btDeformableGravityForce> gravity_;
    btDeformableMultiBodyDynamicsWorld world_;
    btScalar time_step_;
    btSoftBody* body_ = nullptr;
};

}  // namespace

std::unique_ptr<Peer> make_bullet(const Problem& problem) { return std::make_unique<Bullet>(problem); }

}  // namespace supple::peers
