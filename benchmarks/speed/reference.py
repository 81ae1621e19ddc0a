"""Reference time of all benchmarks: `pin.computeDistances` for the same configurations."""

import time

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.lattice.layered_lattice import LayeredLattice


class Reference:
    """Plain Pinocchio and Coal over all nodes of a lattice, without code of this package."""

    def __init__(self, problem):
        lattice = LayeredLattice(problem)
        layers = [lattice.layer(i) for i in range(lattice.divisions + 1)]
        layers[0], layers[-1] = layers[0][[lattice.origin]], layers[-1][[lattice.origin]]
        self.configurations = np.concatenate(layers)
        self.model = problem.robot.model
        self.geometry = pin.GeometryModel()
        links = [
            self.geometry.addGeometryObject(g)
            for g in problem.robot.collision_model.geometryObjects
        ]
        for k, (c, r) in enumerate(zip(problem.scene.centers, problem.scene.radii, strict=True)):
            sphere = pin.GeometryObject(f"s{k}", 0, pin.SE3(np.eye(3), c), coal.Sphere(float(r)))
            index = self.geometry.addGeometryObject(sphere)
            for link in links:
                self.geometry.addCollisionPair(pin.CollisionPair(link, index))
        self.data, self.geometry_data = self.model.createData(), self.geometry.createData()

    def run(self):
        """Evaluate all configurations; return their least distances."""
        model, data = self.model, self.data
        geometry, geometry_data = self.geometry, self.geometry_data
        results = geometry_data.distanceResults
        least = []
        for q in self.configurations:
            pair = pin.computeDistances(model, data, geometry, geometry_data, q)
            least.append(results[pair].min_distance)
        return least

    def seconds(self, repeats=7):
        """Median time of `run`."""
        times = []
        for _ in range(repeats):
            begin = time.perf_counter()
            self.run()
            times.append(time.perf_counter() - begin)
        return float(np.median(times))


def record(benchmark, reference):
    """Measure the reference's time and add it, and the ratio to it, to a benchmark's record."""
    seconds = reference.seconds()
    benchmark.extra_info["compute_distances_seconds"] = seconds
    benchmark.extra_info["ratio"] = benchmark.stats.stats.median / seconds
