// Patrol: drive on while the way is free, else turn to the freer side.
#include <libplayerc++/playerc++.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
using namespace PlayerCc;

int main(int argc, char** argv) {
  PlayerClient robot("localhost", argc > 1 ? std::atoi(argv[1]) : 6665);
  Position2dProxy base(&robot, 0);
  LaserProxy laser(&robot, 0);
  BlobfinderProxy camera(&robot, 0);
  base.SetMotorEnable(true);

  int seen = 0;
  for (int round = 0; round < 300; round++) {
    robot.Read();
    double ahead = 8.0, left = 0.0, right = 0.0;
    for (unsigned i = 0; i < laser.GetCount(); i++) {
      double bearing = laser.GetBearing(i), range = laser.GetRange(i);
      if (std::fabs(bearing) < 0.5) ahead = std::min(ahead, range);
      (bearing > 0 ? left : right) += range;
    }
    seen += camera.GetCount() > 0;
    if (ahead > 1.0)
      base.SetSpeed(0.5, 0.0);
    else
      base.SetSpeed(0.0, left > right ? 0.8 : -0.8);
  }
  base.SetSpeed(0.0, 0.0);
  std::cout << "at " << base.GetXPos() << " " << base.GetYPos() << " after "
            << base.GetDataTime() << " s; orange in " << seen << " pictures" << std::endl;
}
