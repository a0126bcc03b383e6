#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include <cmath>
#include <regex>

#include "command.h"
#include "delio/map/page.h"
#include "page_file.h"
#include "test_data.h"
#include "virtual_display.h"

namespace {
using namespace delio;
using map::MapPoint;
using mrpt::img::TColor;

MapPoint pointAt(float x, float y, float z) {
    MapPoint point;
    point.position = {x, y, z};
    point.intensity = x < 0 ? 10.0F : 90.0F;
    point.time_s = 20 + x;
    point.observations = static_cast<std::uint16_t>(20 + y);
    return point;
}

/** Ground of 40 m by 20 m about the origin, a wall of 6 m in the north, a mover in the south. The
 *  west is dark, the east is bright. */
map::PageContent toyMap() {
    map::PageContent content;
    content.title = "A toy";
    for (int i = -200; i < 200; ++i) {
        const float x = 0.05F + 0.1F * static_cast<float>(i);
        for (int k = -100; k <= 80; ++k)
            content.points.push_back(pointAt(x, 0.1F * static_cast<float>(k), 0));
        for (int k = 1; k <= 60; ++k)
            content.points.push_back(pointAt(x, 8, 0.1F * static_cast<float>(k)));
    }
    for (int i = 0; i < 30; ++i)
        for (int k = 0; k < 20; ++k)
            content.dynamic.push_back(
                pointAt(-12 + 0.1F * static_cast<float>(i), -7 + 0.1F * static_cast<float>(k), 1));
    for (int i = 0; i <= 30; ++i) {
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.translation() << i - 15, -3, 1.7;
        content.trajectory.push_back(pose);
        pose.translation().y() = -3.5 - 0.05 * i;
        content.odometry.push_back(pose);
        pose.translation().y() = -2.5;
        content.truth.push_back(pose);
    }
    content.loops = {{0, 30}};
    return content;
}

struct Shot {
    std::string dom, state;
    mrpt::img::CImage image;

    TColor at(int x, int y) const {
        const auto* pixel =
            image.ptr<std::uint8_t>(static_cast<unsigned>(x), static_cast<unsigned>(y));
        return {pixel[2], pixel[1], pixel[0]};  // CImage has blue first
    }
    /** Pixels of a rectangle that `is` holds for. */
    template <typename Is>
    int count(int x0, int y0, int x1, int y1, const Is& is) const {
        int found = 0;
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) found += is(at(x, y)) ? 1 : 0;
        return found;
    }
};

bool isRed(const TColor& c) { return c.R > 200 && c.G < 90 && c.B < 80; }
bool isOrange(const TColor& c) { return c.R > 230 && c.G > 130 && c.G < 175 && c.B < 80; }
bool isGreen(const TColor& c) { return c.R < 110 && c.G > 205 && c.B < 140; }
bool isWhite(const TColor& c) { return c.R > 245 && c.G > 245 && c.B > 245; }
bool isDark(const TColor& c) { return c.R < 30 && c.G < 33 && c.B < 38; }
bool isDarkGray(const TColor& c) { return std::abs(c.R - 51) < 6 && c.R == c.G && c.G == c.B; }

class PageInBrowser : public testing::Test {
 protected:
    void SetUp() override {
        if (!test::isInstalled("chromium")) {
            if (test::dataIsRequired()) FAIL() << "chromium is not installed";
            GTEST_SKIP() << "chromium is not installed (share/scripts/dependencies test)";
        }
        map::savePage(toyMap(), folder_ / "map.html");
    }

    /** Opens the page as its reader does, without a network, screen or graphics card. */
    Shot open(const std::string& state, const std::string& size = "1280,800",
              const std::string& more = "--enable-unsafe-swiftshader") const {
        const std::string picture = folder_ / "shot.png";
        const auto browse = [&] {
            return test::runTool(
                "timeout",
                {"60", "chromium", "--headless=new", "--no-sandbox", "--use-gl=angle",
                 "--use-angle=swiftshader", more, "--window-size=" + size, "--hide-scrollbars",
                 "--user-data-dir=" + std::string(folder_ / "chromium"), "--enable-logging=stderr",
                 "--virtual-time-budget=3000", "--dump-dom", "--screenshot=" + picture,
                 "file://" + std::string(folder_ / "map.html") + "#" + state});
        };
        constexpr int kTimeout = 124;
        auto run = browse();
        if (run.exitCode == kTimeout) run = browse();  // Chromium itself hangs once in a while
        EXPECT_EQ(run.exitCode, 0) << run.err;
        EXPECT_EQ(run.err.find("CONSOLE"), std::string::npos) << run.err;
        Shot shot;
        shot.dom = run.out;
        std::smatch found;
        if (std::regex_search(run.out, found, std::regex("data-state=\"([^\"]*)\"")))
            shot.state = found[1];
        EXPECT_TRUE(shot.image.loadFromFile(picture));
        return shot;
    }

    /** The same, where the page has to come to its end. */
    Shot ready(const std::string& state, const std::string& size = "1280,800") const {
        auto shot = open(state, size);
        EXPECT_EQ(shot.state, "ready 96400 points");
        return shot;
    }

    test::TemporaryFolder folder_;
};

// On 1280 pixels the panel takes the 300 on the left: the map's middle is at 790, 400.
constexpr const char* kTopInGray = "view=top&color=intensity&colours=gray&size=20";

TEST_F(PageInBrowser, ShowsTheMapItsLinesAndThePanel) {
    const auto shot = ready(kTopInGray);
    ASSERT_EQ(shot.image.getWidth(), 1280U);
    ASSERT_EQ(shot.image.getHeight(), 800U);
    EXPECT_GT(shot.count(400, 300, 750, 400, isDarkGray), 0.95 * 350 * 100);
    EXPECT_GT(shot.count(830, 300, 1180, 400, isWhite), 0.95 * 350 * 100);
    EXPECT_GT(shot.count(310, 60, 1280, 120, isDark), 0.95 * 970 * 60);  // beyond the map
    EXPECT_GT(shot.count(300, 400, 790, 800, isWhite), 500);             // the trajectory
    EXPECT_GT(shot.count(300, 400, 1280, 800, isOrange), 1000);
    EXPECT_GT(shot.count(300, 400, 790, 800, isGreen), 500);
    EXPECT_EQ(shot.count(300, 60, 1280, 770, isRed), 0);
    EXPECT_GT(shot.count(12, 70, 290, 500, isDark), 0.5 * 278 * 430);  // the panel, and its words
    EXPECT_GT(shot.count(12, 70, 290, 500, [](const TColor& c) { return c.R > 200; }), 1000);
    EXPECT_NE(shot.dom.find("96\u202f400 points \u00b7 40 \u00d7 18 \u00d7 6 m"),
              std::string::npos);
}

TEST_F(PageInBrowser, AnAddressSwitchesWhatIsShown) {
    const auto bare = ready(std::string(kTopInGray) +
                            "&dynamic=1&trajectory=0&odometry=0&truth=0&loops=0&panel=0");
    EXPECT_EQ(bare.count(0, 60, 640, 770, isWhite), 0);
    EXPECT_EQ(bare.count(0, 60, 1280, 770, isOrange), 0);
    EXPECT_GT(bare.count(0, 400, 640, 770, isRed), 1000);  // the mover, and no panel over it
    EXPECT_EQ(bare.count(640, 400, 1280, 770, isRed), 0);

    const auto section = ready(std::string(kTopInGray) + "&low=3");
    EXPECT_GT(section.count(400, 300, 750, 400, isDark), 0.99 * 350 * 100);  // no ground
    EXPECT_GT(section.count(300, 60, 790, 300, isDarkGray), 300);            // but the wall

    const auto byTime = ready("view=top&color=time&size=20");
    const TColor west = byTime.at(400, 350), east = byTime.at(1180, 350);
    EXPECT_GT(west.B, west.R + 50);
    EXPECT_GT(east.R, east.B + 50);
}

TEST_F(PageInBrowser, ShowsHeightAboveTheGroundAtFirst) {
    const auto shot = ready("view=top&size=20");
    const TColor street = shot.at(600, 350);
    EXPECT_GT(street.B, street.R + 50);
    EXPECT_EQ(shot.count(310, 60, 1280, 770, isDarkGray), 0);
    EXPECT_NE(shot.dom.find("m above the ground</span>"), std::string::npos);
}

TEST_F(PageInBrowser, ASectionLooksInside) {
    const auto shot = ready(std::string(kTopInGray) + "&x-min=0&y-max=5");
    EXPECT_EQ(shot.count(310, 60, 1200, 770, isDarkGray), 0);  // no west
    EXPECT_GT(shot.count(310, 60, 1200, 770, [](const TColor& c) { return c.R > 200; }), 50000);
}

TEST_F(PageInBrowser, AGeoreferencedMapHasNorthUp) {
    auto content = toyMap();
    content.north = Eigen::Vector3d::UnitX();
    map::savePage(content, folder_ / "map.html");
    const auto shot = ready(kTopInGray);
    EXPECT_NE(shot.dom.find("aria-label=\"Arrow to north\""), std::string::npos);
    EXPECT_NE(shot.dom.find("transform=\"rotate(0.0)\""), std::string::npos);
    EXPECT_GT(shot.count(760, 100, 820, 300, isWhite),
              0.5 * 60 * 200);  // the east of the map is up
    EXPECT_GT(shot.count(760, 500, 820, 700, isDarkGray), 0.5 * 60 * 200);
}

TEST_F(PageInBrowser, FitsAPhone) {
    const std::string phone = "375,667";
    const auto shot = ready(kTopInGray, phone);
    ASSERT_EQ(shot.image.getWidth(), 375U);
    EXPECT_GT(shot.count(50, 310, 180, 330, isDarkGray), 0.9 * 130 * 20);
    EXPECT_GT(shot.count(200, 310, 330, 330, isWhite), 0.9 * 130 * 20);
    // A button and no panel, which then comes with a margin on its right.
    EXPECT_GT(shot.count(12, 12, 90, 48, [](const TColor& c) { return c.R > 200; }), 30);
    const auto border = [](const TColor& c) { return c.R > 50 && c.R < 70 && c.B > c.R + 10; };
    EXPECT_EQ(shot.count(364, 70, 365, 400, border), 0);
    const auto open = ready(std::string(kTopInGray) + "&panel=1", phone);
    EXPECT_GT(open.count(364, 70, 365, 400, border), 300);
    EXPECT_EQ(open.count(368, 70, 375, 200, isDark), 7 * 130);
}

// What a mouse does, from within the page: each line says whether the page did what it must.
const char* const kMouse = R"(<script>
const said = [];
const say = (name, is) => said.push(name + (is ? ' yes' : ' NO'));
function mouse(type, x, y, more) {
  const event = type.startsWith('pointer') ? PointerEvent : MouseEvent;
  canvas.dispatchEvent(new event(type, {clientX: x, clientY: y, button: 0, bubbles: true,
                                        cancelable: true, ...more}));
}
function drag(dx, dy, more) {
  mouse('mousedown', 400, 300, more);
  mouse('mousemove', 400 + dx, 300 + dy, more);
  mouse('mouseup', 400 + dx, 300 + dy, more);
}
/** Where a place of the map is in the picture, pixels. */
function seen(place) {
  const at = place.clone().project(camera);
  return [(at.x + 1) / 2 * canvas.clientWidth, (1 - at.y) / 2 * canvas.clientHeight];
}
function click(...place) {
  draw();
  const at = seen(new THREE.Vector3(...place));
  for (const type of ['pointerdown', 'click']) mouse(type, ...at);
}
const covered = window.innerWidth > 640 ? byId('panel').getBoundingClientRect().right : 0;
draw();
say('whole', [...Array(8).keys()].map(i => seen(new THREE.Vector3(
    ...['x', 'y', 'z'].map((axis, k) => (i >> k & 1 ? box.max : box.min)[axis])))).every(
    ([x, y]) => x > covered && x < canvas.clientWidth && y > 0 && y < canvas.clientHeight));
let before = camera.position.clone();
drag(100, -50);
say('turn', camera.position.distanceTo(before) > 1);
before = controls.target.clone();
drag(50, 0, {button: 2});
say('move', controls.target.distanceTo(before) > 0.5);
before = camera.position.distanceTo(controls.target);
canvas.dispatchEvent(new WheelEvent('wheel', {deltaY: -200, cancelable: true}));
say('zoom', camera.position.distanceTo(controls.target) < before);
byId('top').click();
say('top', Math.abs(camera.position.x - controls.target.x) < 0.1);
click(-10, 0, 0);
say('point', /^x -(9[.]9|10[.][01]).*, y -?0[.][01].*, z 0[.]00 m$/.test(byId('result').textContent));
click(5, 8, 6);
const found = byId('result').textContent.match(/; ([0-9.]+) m .*horizontal ([0-9.]+) m, height ([0-9.]+)/);
say('distance', found && Math.abs(found[1] - Math.hypot(15, 8, 6)) < 0.3 &&
    Math.abs(found[2] - Math.hypot(15, 8)) < 0.3 && Math.abs(found[3] - 6) < 0.11);
mouse('pointerdown', 0, 0);
mouse('click', 0, 0);
say('none', byId('result').hidden && !pickedLines);
function slide(id, value) {
  byId(id).value = value;
  byId(id).dispatchEvent(new Event('input'));
}
slide('low', 5);
slide('high', 2);
say('section', byId('high').value === '2' && byId('low').value === '2');
say('text', byId('cuts').textContent.includes('Height above ground2.0 to 2.0 m'));
slide('x-min', -5);
looks.reset();
draw();
say('cut', clouds[0].uniforms.boxLow.value.x === -5.001 && shownBox().min.x === -5);
byId('whole').click();
say('whole again', shownBox().equals(box) && byId('cuts').textContent.match(/all/g).length === 4);
byId('top').click();
function barIsTrue() {  // and of a round length: 1, 2 or 5 with zeros
  draw();
  const length = parseFloat(byId('scale-text').textContent);
  const bar = byId('scale-bar').getBoundingClientRect().width;
  const [from, to] = [0, length].map(x => seen(controls.target.clone().add(vector([x, 0, 0])))[0]);
  return '125'.includes(length.toExponential(6)[0]) && Number(length.toPrecision(1)) === length &&
      Math.abs(to - from - bar) < 1 && bar < 150;
}
say('bar', barIsTrue());
const wide = byId('scale-text').textContent;
function press(key, more) {
  canvas.dispatchEvent(new KeyboardEvent('keydown', {key, cancelable: true, ...more}));
}
for (let i = 0; i < 12; ++i) press('+');
say('zoomed bar', barIsTrue() && byId('scale-text').textContent !== wide);
const turned = () => byId('needle').getAttribute('transform');
say('up', turned() === 'rotate(0.0)' && byId('north-letter').textContent === 'y' &&
    byId('north').getAttribute('aria-label').includes('not georeferenced'));
press('ArrowLeft', {shiftKey: true});
draw();
say('keys turn', turned() === 'rotate(-5.0)' || turned() === 'rotate(5.0)');
fold(false);
say('finger', [...document.querySelectorAll('button, select, input[type=range], .check')].every(
    each => each.getBoundingClientRect().height >= 40));
say('width', document.documentElement.scrollWidth <= window.innerWidth &&
    byId('panel').scrollWidth <= byId('panel').clientWidth);
say('labels', [...document.querySelectorAll('input, select')].every(each => each.labels.length));
setTimeout(() => {
  draw();  // what may still be asked for on a busy machine
  say('rest', !asked);
  document.body.dataset.said = said.join(', ');
}, 1500);
</script></body>)";

TEST_F(PageInBrowser, ObeysTheMouse) {
    auto page = test::readText(folder_ / "map.html");
    page.replace(page.rfind("</body>"), 7, kMouse);
    test::writeText(folder_ / "map.html", page);
    const std::string all =
        "whole yes, turn yes, move yes, zoom yes, top yes, point yes, distance yes, none yes, "
        "section yes, text yes, cut yes, whole again yes, bar yes, zoomed bar yes, up yes, keys "
        "turn "
        "yes, finger yes, width yes, labels yes, rest yes";
    const auto saidAt = [&](const char* size) -> std::string {
        const auto shot = ready("", size);
        std::smatch found;
        if (!std::regex_search(shot.dom, found, std::regex("data-said=\"([^\"]*)\""))) return "";
        return found[1];
    };
    for (const char* size : {"1280,800", "375,667"}) {
        // On a busy machine the last picture may come after the page's virtual time.
        std::string said = saidAt(size);
        for (int again = 0; again < 3 && said != all; ++again) said = saidAt(size);
        EXPECT_EQ(said, all) << size;
    }
}

TEST_F(PageInBrowser, SaysWhereThereIsNoWebGl) {
    const auto shot = open("", "1280,800", "--disable-3d-apis");
    EXPECT_EQ(shot.state.rfind("error: This page needs WebGL", 0), 0U) << shot.state;
    EXPECT_GT(shot.count(400, 300, 900, 500, isWhite), 10000);
}
}  // namespace
