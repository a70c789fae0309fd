"""The base of every node: life cycle, contract, parameters, diagnostics, callbacks that cannot kill it."""

import traceback
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar, Generic, TypeVar

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn

from robustnav_msgs_py import contract
from robustnav_msgs_py.conversions import status_to_message
from robustnav_msgs_py.conversions.stamps import header
from robustnav_msgs_py.errors import ContractError, RobustnavError
from robustnav_msgs_py.values import ERROR, WARN
from robustnav_nodes.graph.health import Health
from robustnav_nodes.graph.node_parameters import NodeParameters
from robustnav_nodes.graph.wiring import Outlet, RosWiring, Wiring, Work

P = TypeVar("P")
V = TypeVar("V")

DIAGNOSTICS_PERIOD_S = 1.0


class GraphNode(LifecycleNode, Generic[P]):
    """A lifecycle node that takes topics, types and QoS from the contract and parameters from a declaration.

    A subclass names its `executable` (its rows in the contract) and its `declaration`, and overrides any of
    `configure`, `activate`, `deactivate`, `cleanup`. What these raise fails the transition with a log line.
    One that must hear what was said before it was told to stop goes on hearing for `listen_on_s` seconds.
    One whose work has an end sets `exit_code` when it is done; the process that runs it then leaves with it.
    Publishers, subscriptions, timers, services and workers made in `configure` are taken down at clean-up.

    Callbacks run in the executor's thread and only while the node is active. A RobustnavError raised there
    (a bad message) is logged once and shown in /diagnostics; any other exception is logged with its
    traceback; the node lives on.

    `wiring` makes what joins the node to the others: ROS, unless a run in lock-step brings its own.
    """

    executable: ClassVar[str]
    declaration: ClassVar[type]
    listen_on_s: ClassVar[float] = 0.0
    exit_code: int | None = None

    def __init__(
        self, *, wiring: Callable[["GraphNode[Any]"], Wiring] = RosWiring, **node_options: Any
    ) -> None:
        super().__init__(self.executable, enable_logger_service=True, **node_options)
        self._wiring = wiring(self)
        self.health = Health(self._log, self.steady_s)
        self._held: dict[str, deque[Callable[[], None]]] = {}
        self._waiting_for: list[str] = []
        self._active = False
        self._silent_since_s = self.steady_s()
        self.declare_parameter(
            "autostart",
            True,
            ParameterDescriptor(description="configure and activate at start; false where a manager does it"),
        )
        try:
            self._bound: NodeParameters[P] = NodeParameters(self, self.declaration, self._parameters_changed)
        except RobustnavError:
            GraphNode.destroy_node(self)  # or its shared memory would stay behind; no subclass is made yet
            raise
        self._service_change_state.callback = self._on_change_state
        # A wiring of its own, which clean-up leaves alone: diagnostics go on in every state, and while
        # simulated time stands.
        always = wiring(self)
        self._diagnostics = always.publisher(contract.topic("/diagnostics"), managed=False)
        always.timer(DIAGNOSTICS_PERIOD_S, self._publish_diagnostics, steady=True)
        for name in sorted(self.unknown_parameters):
            self.health.problem(f"parameter {name}", "there is no such parameter; is it misspelt?")

    # What a subclass overrides.

    def configure(self) -> None:
        """Make publishers, subscriptions, timers and services; nothing runs yet."""

    def activate(self) -> None:
        """Start working; publishers are open."""

    def deactivate(self) -> None:
        """Stop working; publishers are still open, so that a last word can be said."""

    def cleanup(self) -> None:
        """Give back what `configure` took beyond what the base takes down."""

    def parameters_changed(self) -> None:
        """Called after a parameter was set while the node runs; `self.parameters` is new."""

    def destroy_node(self) -> None:
        """Take the node down, and with it the state machine, which rclpy leaves alone.

        It holds the node's place in the middleware, whose threads would go on until the garbage is collected,
        or past the end of Python.
        """
        super().destroy_node()
        self._state_machine.destroy_when_not_in_use()

    @property
    def unknown_parameters(self) -> frozenset[str]:
        """Names given at start-up that the node does not have: most likely misspelt."""
        return frozenset(self._bound.unknown_overrides())

    # What a subclass uses.

    @property
    def parameters(self) -> P:
        """The parameters as they are now, checked."""
        return self._bound.values

    @property
    def autostart(self) -> bool:
        """Whether the node brings itself up (`ros2 run`) instead of waiting for a manager."""
        return bool(self.get_parameter("autostart").value)

    @property
    def is_active(self) -> bool:
        """Whether the node is in the state `active`."""
        return self._active

    def now_ns(self) -> int:
        """ROS time (simulated where `use_sim_time` is set), nanoseconds."""
        return self._wiring.now_ns()

    def steady_s(self) -> float:
        """Wall time that never jumps, seconds from an arbitrary start."""
        return self._wiring.steady_s()

    def publisher(self, name: str) -> Outlet:
        """A publisher of a topic that the contract says this node speaks on."""
        row = contract.topic(name)
        if row not in contract.spoken_by(self.executable):
            raise ContractError(f"{self.executable!r} is no speaker of {name!r} in the contract")
        return self._wiring.publisher(row)

    def subscribe(self, name: str, read: Callable[[Any], V], use: Callable[[V], object]) -> None:
        """Hear a topic of the contract: `read` makes the value (a conversion), `use` takes it.

        Latched messages that come before the node is active are held until it is; others are dropped.
        """
        row = contract.topic(name)
        if row not in contract.heard_by(self.executable):
            raise ContractError(f"{self.executable!r} is no listener of {name!r} in the contract")
        self._waiting_for.append(name)

        def hear(message: Any) -> None:
            if name in self._waiting_for:
                self._waiting_for.remove(name)
            use(read(message))

        def hear_or_hold(message: Any) -> None:
            if self._active:
                self._guard(name, hear, message)
            elif row.qos.latched:
                held = self._held.setdefault(name, deque(maxlen=row.qos.depth))
                held.append(partial(self._guard, name, hear, message))

        self._wiring.subscription(row, hear_or_hold)

    def serve(self, name: str, answer: Callable[[Any, Any], Any]) -> None:
        """Offer a service of the contract; `answer(request, response)` returns the response.

        When it raises a RobustnavError, the response's `success` is False and its `message` the sentence
        (where it has these fields).
        """
        row = contract.service(name, self.executable)

        def respond(request: Any, response: Any) -> Any:
            if not self._active:
                self._refuse(response, f"{self.executable} is not active")
                return response
            try:
                return answer(request, response)
            except Exception as error:
                own = not isinstance(error, RobustnavError)
                self._refuse(
                    response, "the node met an error of its own; its log has it" if own else str(error)
                )
                self._report(name, error)
            return response

        self._wiring.service(name, row.type, respond)

    def every(self, period_s: float, work: Callable[[], None], *, steady: bool = False) -> None:
        """Call `work` each `period_s` seconds of ROS time (or of wall time where `steady`)."""
        self._wiring.timer(period_s, partial(self._guard, f"timer {work.__name__}", work), steady=steady)

    def worker(self, name: str, failed: Callable[[], None] = lambda: None) -> Work:
        """A thread for long work, whose results come back to the executor's thread.

        A job that raises is reported like a callback; then `failed` is called.
        """

        def report(error: BaseException) -> None:
            self._report(name, error)
            failed()

        return self._wiring.worker(partial(self._guard, name), report)

    # Life cycle.

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `configure`."""
        return self._transition(
            "configure", self.configure, lambda: super(GraphNode, self).on_configure(state)
        )

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Open the publishers, then run `activate`."""
        opened = super().on_activate(state)
        self._active = True
        result = self._transition("activate", self.activate, lambda: opened)
        self._active = result == TransitionCallbackReturn.SUCCESS
        if self._active:
            self.get_logger().info(f"{self.executable} is active")
            for hear in [hear for held in self._held.values() for hear in held]:
                hear()
            self._held.clear()
        return result

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `deactivate`, then close the publishers."""
        self._attempt("deactivate", self.deactivate)
        self._active = False
        self._silent_since_s = self.steady_s()
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `cleanup`, then take down what `configure` made, once the node's last words are received."""
        self._attempt("clean up", self.cleanup)
        self._take_down()
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Deactivate and clean up, from wherever the node is."""
        if self._active:
            self.on_deactivate(state)
        return self.on_cleanup(state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take everything down; the node can be configured again."""
        self._active = False
        self._silent_since_s = self.steady_s()
        self._attempt("clean up", self.cleanup)
        self._take_down()
        return TransitionCallbackReturn.SUCCESS

    def _attempt(self, name: str, work: Callable[[], None]) -> None:
        """Going down cannot be refused: what fails is reported, and the rest is taken down all the same."""
        try:
            work()
        except Exception as error:
            self._report(f"cannot {name}", error, level=ERROR)

    def _transition(
        self, name: str, work: Callable[[], None], after: Callable[[], TransitionCallbackReturn]
    ) -> TransitionCallbackReturn:
        try:
            work()
            return after()
        except Exception as error:  # rclpy would swallow it and go to on_error without a word
            self._report(f"cannot {name}", error, level=ERROR)
            if name == "configure":
                self._attempt("clean up", self.cleanup)
                self._take_down()
            return TransitionCallbackReturn.FAILURE

    def _take_down(self) -> None:
        self._wiring.take_down(self._silent_since_s)
        self._waiting_for.clear()
        self._held.clear()

    def _on_change_state(self, request: Any, response: Any) -> Any:
        # rclpy lets an impossible transition raise out of the executor, which ends the node without a reply
        try:
            return self._LifecycleNodeMixin__on_change_state(request, response)
        except rclpy_implementation.RCLError as error:
            state = self._state_machine.current_state[1]
            wanted = request.transition.label or request.transition.id
            self.health.problem("life cycle", f"no transition {wanted!r} from state {state!r}: {error}")
            response.success = False
            return response

    @property
    def state_id(self) -> int:
        """The state of the life cycle, a constant of lifecycle_msgs/State."""
        return int(self._state_machine.current_state[0])

    # Callbacks that cannot kill the node.

    def _guard(self, where: str, work: Callable[..., None], *arguments: Any) -> None:
        if not self._active:
            return
        try:
            work(*arguments)
        except Exception as error:
            self._report(where, error)

    def _report(self, where: str, error: BaseException, level: int = WARN) -> None:
        if isinstance(error, RobustnavError):
            self.health.problem(where, str(error), level)
        else:
            trace = "\n" + "".join(traceback.format_exception(error))
            self.health.problem(where, f"{type(error).__name__}: {error}", ERROR, detail=trace)

    def _parameters_changed(self, _values: P) -> None:
        try:
            self.parameters_changed()
        except Exception as error:
            self._report("parameters", error)

    def _publish_diagnostics(self) -> None:
        waiting = self._waiting_for if self._active else []
        for name in waiting:
            self._check_publishers(name)
        status = self.health.status(self.get_fully_qualified_name(), waiting)
        message = DiagnosticArray(header=header(self.now_ns(), ""), status=[status_to_message(status)])
        self._diagnostics.publish(message)

    def _check_publishers(self, name: str) -> None:
        """Say so where somebody speaks on a latched topic without latching: DDS then delivers nothing."""
        if not contract.topic(name).qos.latched:
            return
        for speaker in self._wiring.volatile_speakers(contract.topic(name)):
            self.health.problem(
                name,
                f"{speaker!r} publishes {name} volatile, so it is not heard: publish it "
                f"transient local, or set the qos_overrides of {name} to volatile",
            )

    def _log(self, level: int, sentence: str) -> None:
        logger = self.get_logger()
        # rclpy ties a severity to each calling line, so each level has a line of its own
        if level == ERROR:
            logger.error(sentence)
        else:
            logger.warning(sentence)

    @staticmethod
    def _refuse(response: Any, sentence: str) -> None:
        if hasattr(response, "success"):
            response.success, response.message = False, sentence
