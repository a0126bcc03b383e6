#include "traffic.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace delio::synth {
namespace {
constexpr double kPi = 3.14159265358979323846;
constexpr std::uint64_t kStripeKey = 0x57A1, kMemberKey = 0x3E3B;
constexpr double kNearest_m = 8.5;       // middle of the car before or behind the vehicle's
constexpr double kQueue_m = 13.5;        // from car to car in the vehicle's lane
constexpr double kNearestWalker_m = 3;   // of those who walk along with the sensor
constexpr double kWalkers_m = 2.3;       // from one of them to the next
constexpr double kSlowTraffic_m_s = 14;  // there people walk and cycle beside it

/** Room from the middle of one to the middle of the next. */
double spacing(RoadUserKind kind) { return longest_m(kind) + (kind == RoadUserKind::kCar ? 7 : 2); }

bool isOnFoot(RoadUserKind kind) { return kind == RoadUserKind::kPedestrian; }

/** From one that goes along with the vehicle to the next. */
double queue(RoadUserKind kind) { return isOnFoot(kind) ? kWalkers_m : kQueue_m; }

/** Into [-reach, reach). */
double wrapped(double value, double reach) {
    return value - 2 * reach * std::floor((value + reach) / (2 * reach));
}

Eigen::Isometry3d uprightAt(Eigen::Isometry3d pose) {
    const double yaw = std::atan2(pose(1, 0), pose(0, 0));
    pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return pose;
}

/** How far ahead and behind there is traffic. */
double reachOn(const Road& road) {
    constexpr double kJustLeft_m = 40;  // that is still the same stretch
    double shortestRound_m = std::numeric_limits<double>::max();
    for (double s = 0; s < road.path().end(); s += 5) {
        if (road.owns(s)) continue;
        for (const double before : road.stationsNear(road.point(s, 0), 1))
            if (s - before > kJustLeft_m) shortestRound_m = std::min(shortestRound_m, s - before);
    }
    return std::clamp(0.4 * shortestRound_m, Traffic::kLeastReach_m, Traffic::kReach_m);
}
}  // namespace

std::vector<Traffic::Stripe> Traffic::footwaysOf(const Road& road, Random random) {
    std::vector<Stripe> stripes;
    for (const double side : road.profile().footways) {
        const double speed = random.uniform(1.1, 1.6), wave = side == 0 ? 23 : 0;
        stripes.push_back({RoadUserKind::kPedestrian, side, side > 0 ? -1 : 1, speed, wave});
    }
    return stripes;
}

std::vector<Traffic::Stripe> Traffic::stripesOf(const Road& road, Random random) {
    if (!road.profile().footways.empty()) return footwaysOf(road, random);
    const auto& lanes = road.lanes();
    std::vector<Stripe> stripes = {{RoadUserKind::kCar, lanes[0].side_m, 1, 0, 80, 4}};
    bool beside = false;
    for (std::size_t i = 1; i < lanes.size(); ++i) {
        const auto& lane = lanes[i];
        const double speed = lane.speed_m_s * random.uniform(0.85, 1.1);
        // The first lane in the vehicle's own direction goes along with it: cars beside it.
        const double wave = lane.direction > 0 && !beside ? 700 : 0;
        beside |= lane.direction > 0;
        stripes.push_back({RoadUserKind::kCar, lane.side_m, lane.direction, speed, wave, 4});
    }
    if (lanes[0].speed_m_s > kSlowTraffic_m_s) return stripes;
    for (const int direction : {1, -1}) {
        const int side = -direction;  // traffic keeps to the right
        double edge = 0;
        for (const auto& lane : lanes) edge = std::max(edge, side * lane.side_m);
        stripes.push_back({RoadUserKind::kPedestrian, side * (Road::kKerb_m + 1.5), direction,
                           random.uniform(1.2, 1.6), 0, 1.5});
        stripes.push_back(
            {RoadUserKind::kCyclist, side * (edge + 1.55), direction, random.uniform(4, 6), 0, 1});
    }
    return stripes;
}

Traffic::Traffic(const Road& road, const Drive& drive, std::size_t count, std::uint64_t seed)
    : road_(road),
      drive_(drive),
      seed_(seed),
      reach_m_(reachOn(road)),
      stripes_(stripesOf(road, {seed, kStripeKey})) {
    std::vector<std::size_t> stripeOf;
    for (std::size_t i = 0; i < count; ++i) {
        const auto stripe = nextStripe();
        if (stripe == stripes_.size()) break;
        stripeOf.push_back(stripe);
        ++stripes_[stripe].members;
    }
    std::vector<std::size_t> numbers(stripes_.size(), 0);
    for (const auto stripe : stripeOf) members_.push_back(makeMember(stripe, numbers[stripe]++));
}

/** The one with the fewest members for its share that has room for another; past the end: none. */
std::size_t Traffic::nextStripe() const {
    std::size_t best = stripes_.size();
    double fewest = 0;
    for (std::size_t i = 0; i < stripes_.size(); ++i) {
        const Stripe& stripe = stripes_[i];
        const double gap = stripe.wave_m > 0 ? queue(stripe.kind) : spacing(stripe.kind);
        if (static_cast<double>(stripe.members + 2) * gap > 2 * (reach_m_ - kNearest_m)) continue;
        const double load = static_cast<double>(stripe.members + 1) / stripe.share;
        if (best < stripes_.size() && load >= fewest) continue;
        best = i;
        fewest = load;
    }
    return best;
}

Traffic::Member Traffic::makeMember(std::size_t stripeNumber, std::size_t number) const {
    const Stripe& stripe = stripes_[stripeNumber];
    Random random{seed_, kMemberKey, stripeNumber, number};
    Member member;
    member.stripe = stripeNumber;
    member.looks = makeRoadUser(stripe.kind, random.next());
    member.phase = random.uniform(0, 2 * kPi);
    member.swing_m = 0;
    member.sway_m = random.uniform(-1, 1) * (stripe.kind == RoadUserKind::kPedestrian ? 0.1 : 0.04);
    const std::size_t pair = number / 2;  // one before, one behind
    const double end = number % 2 == 0 ? 1 : -1;
    if (stripe.wave_m > 0 && isOnFoot(stripe.kind)) {
        member.ahead_m = end * (kNearestWalker_m + kWalkers_m * static_cast<double>(pair));
        member.swing_m = 0.5;
    } else if (stripe.wave_m > 0 && stripeNumber == 0) {
        member.ahead_m = end * (kNearest_m + kQueue_m * static_cast<double>(pair));
        member.swing_m = number < 2 ? 0.8 : 2;
    } else if (stripe.wave_m > 0) {
        member.ahead_m =
            number == 0 ? 0 : end * kQueue_m * std::ceil(static_cast<double>(number) / 2);
        member.swing_m = 12;
        member.phase = Random{seed_, kMemberKey, stripeNumber}.uniform(0, 2 * kPi);  // all as one
    } else {
        const double room = 2 * reach_m_ / static_cast<double>(stripe.members);
        const double play = (room - spacing(stripe.kind)) / 2;
        member.ahead_m = room * static_cast<double>(number) + play * random.uniform(-1, 1);
    }
    return member;
}

RoadUserKind Traffic::kind(std::size_t member) const {
    return stripes_[members_[member].stripe].kind;
}

bool Traffic::accompanies(std::size_t member) const {
    return stripes_[members_[member].stripe].wave_m > 0;
}

double Traffic::ahead(std::size_t index, double time_s) const {
    const Member& member = members_[index];
    const Stripe& stripe = stripes_[member.stripe];
    const double own = drive_.stationAt(time_s);
    // Swinging with the way, not with time: a companion stands when the vehicle does.
    if (stripe.wave_m > 0)
        return member.ahead_m +
               member.swing_m * std::sin(2 * kPi * own / stripe.wave_m + member.phase);
    const double travelled = stripe.direction * stripe.speed_m_s * time_s;
    return wrapped(member.ahead_m + travelled - own, reach_m_);
}

Eigen::Isometry3d Traffic::pose(std::size_t index, double time_s) const {
    const Member& member = members_[index];
    const Stripe& stripe = stripes_[member.stripe];
    const double s = drive_.stationAt(time_s) + ahead(index, time_s);
    Eigen::Isometry3d along =
        poseOnRoad(road_, s, stripe.side_m + member.sway_m, member.looks.footprint);
    // Sidewalks are level enough for it not to matter; on stairs nobody leans back.
    if (!road_.profile().footways.empty()) along = uprightAt(along);
    if (stripe.direction > 0) return along;
    return along * Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ());
}
}  // namespace delio::synth
