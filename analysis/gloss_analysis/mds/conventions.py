"""Which of all equally good solutions is shown: positions, scale, order and sign of dimensions."""

import numpy as np

__all__ = ["centred_and_scaled", "group_conventions", "scaled_transforms", "signed"]

# Part of the whole variance below which a dimension is rounding.
_DEAD = 1e-12


def group_conventions(
    coordinates: np.ndarray, transforms: np.ndarray, counted: np.ndarray, *, model: str
) -> tuple[np.ndarray, np.ndarray]:
    """Bring a solution to its conventions; the distances of each source change by one factor only.

    Each source's own space has total mean square 1, and the group space is that of the average source: the mean over
    sources of C_k C_k' is 1 in every dimension (weighted), the unit matrix (generalised); where no source gives a
    dimension any weight, all points are 0 in it. Dimensions stand in the order
    of their variance, and the point farthest from the centre has a positive coordinate. Matrices C_k are symmetric,
    since each source's own space may be turned.

    Parameters
    ----------
    coordinates : ndarray, shape (n, p)
    transforms : ndarray, shape (m, p, p)
    counted : ndarray of bool, shape (m,)
        Sources that judged anything. The others are shown as the average one.
    model : {"identity", "weighted", "generalised"}

    Returns
    -------
    coordinates, transforms : ndarray
    """
    m, p = transforms.shape[:2]
    unit = np.tile(np.eye(p), (m, 1, 1))
    z = coordinates - coordinates.mean(axis=0)
    if model == "identity":
        return centred_and_scaled(_on_principal_axes(z)), unit
    metric = np.einsum("kcr,kdr->kcd", transforms, transforms)
    spread = z.T @ z / len(z)
    metric = metric / _or_one(np.einsum("kcd,cd->k", metric, spread))[:, None, None]
    average = metric[counted].mean(axis=0)
    if model == "weighted":
        # A dimension to which no source gives weight has no points apart, for anybody.
        alive = np.diagonal(average) * np.diagonal(spread) > _DEAD
        group = np.where(alive, np.sqrt(np.diagonal(average)), 1.0)
        z = z * np.where(alive, group, 0.0)
        order = np.argsort(-np.mean(z**2, axis=0), kind="stable")
        weights = np.sqrt(np.einsum("krr->kr", metric)) / group
        shape = weights[:, order, np.newaxis] * np.eye(p)
        return signed(z[:, order]), np.where(counted[:, None, None], shape, unit)
    values, vectors = np.linalg.eigh(average)
    values = np.where(values > _DEAD * values.max(), values, 0.0)
    root, inverse = np.sqrt(values), np.divide(1.0, np.sqrt(values), out=np.zeros(p), where=values > 0)
    z = z @ (vectors * root)
    _, _, axes = np.linalg.svd(z, full_matrices=False)
    turned = axes.T if axes.shape == (p, p) else np.eye(p)
    z = z @ turned
    back = turned.T @ (vectors * inverse).T
    sign = np.sign(_extremes(z))
    sign[sign == 0] = 1.0
    z, back = z * sign, sign[:, np.newaxis] * back
    shape = _symmetric_roots(np.einsum("ac,kcd,bd->kab", back, metric, back))
    return z, np.where(counted[:, None, None], shape, unit)


def scaled_transforms(
    coordinates: np.ndarray, transforms: np.ndarray, counted: np.ndarray, *, model: str, one_scale: bool
) -> np.ndarray:
    """Matrices C_k of given coordinates: symmetric, and of a size that leaves the spread of the points as it is.

    Parameters
    ----------
    coordinates, transforms, counted, model
        See `group_conventions`.
    one_scale : bool
        Whether the sizes of the sources' spaces may be compared: then only their root mean square is set to that of the
        coordinates, else that of each source.

    Returns
    -------
    ndarray, shape (m, p, p)
    """
    metric = np.einsum("kcr,kdr->kcd", transforms, transforms)
    z = coordinates - coordinates.mean(axis=0)
    moment = z.T @ z
    size = np.sqrt(np.einsum("kcd,cd->k", metric, moment) / (np.trace(moment) or 1.0))
    if one_scale:
        size = np.full(len(size), np.sqrt(np.mean(size[counted] ** 2)))
    shape = _symmetric_roots(metric) if model == "generalised" else np.abs(transforms)
    unit = np.tile(np.eye(coordinates.shape[1]), (len(transforms), 1, 1))
    return np.where(counted[:, None, None], shape / _or_one(size)[:, None, None], unit)


def centred_and_scaled(coordinates: np.ndarray) -> np.ndarray:
    """Move the centre to the origin and make the total mean square 1."""
    z = coordinates - coordinates.mean(axis=0)
    size = np.sqrt(np.sum(np.mean(z**2, axis=0)))
    return z / size if size > 0 else z


def signed(coordinates: np.ndarray) -> np.ndarray:
    """Reflect each dimension so that its point farthest from the centre is positive."""
    return coordinates * np.where(_extremes(coordinates) < 0, -1.0, 1.0)


def _extremes(coordinates: np.ndarray) -> np.ndarray:
    return coordinates[np.argmax(np.abs(coordinates), axis=0), np.arange(coordinates.shape[1])]


def _on_principal_axes(z: np.ndarray) -> np.ndarray:
    # Any rotation fits equally well: principal axes are the one that everybody can reproduce.
    _, _, axes = np.linalg.svd(z, full_matrices=False)
    return signed(z @ axes.T) if axes.shape == (z.shape[1],) * 2 else signed(z)


def _symmetric_roots(metric: np.ndarray) -> np.ndarray:
    values, vectors = np.linalg.eigh(metric)
    return np.einsum("kac,kc,kbc->kab", vectors, np.sqrt(np.maximum(values, 0.0)), vectors)


def _or_one(values: np.ndarray) -> np.ndarray:
    return np.where(values > 0, values, 1.0)
